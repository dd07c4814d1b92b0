// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "aligned_array.h"
#include "core/simd.h"
#include "kernels/lattice_loops.h"

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief The permutohedral lattice of Adams, Baek and Davis (2010) around N points:
 * where LatticeKernel sums with the Gaussian exp(-|f_i - f_j|^2 / 2) in time linear in
 * N, near enough.
 *
 * Values are splatted to the vertices of the simplex around their point, blurred with
 * the taps 1/2 1 1/2 along every direction in turn, and sliced where they are asked
 * for. Vertices around no point do not exist: values that would pass through them are
 * lost, and which ones depends on the order of the directions. The lattice lies the
 * same way around the least features of the points, wherever these are.
 *
 * The points are sorted into chunks that lie together. Vertices are numbered by the
 * chunk that touches them first, so that the sums of a chunk go to rows of its own:
 * those of its vertices, and partial rows (numbered after the vertices) for those of
 * earlier chunks. No number depends on the threads. */
struct PermutohedralLattice {
  /** \param[in] features d x N, divided by their deviations; d is 1 to 16
   * \param[in] tier instructions to use; for tests
   * \throws InvalidParameterException if a feature is not finite, d is not 1 to 16, or
   * features span so many deviations that the keys of vertices (128 bits) cannot tell
   * them apart: not below 50 at d = 16, more at fewer */
  explicit PermutohedralLattice(const Eigen::Ref<const Eigen::MatrixXf>& features,
                                SimdTier tier = simdTier());

  /** \brief Factor of the sums of the lattice: the integral of the Gaussian by that of
   * splat, blur and slice. */
  float gain() const;

  std::size_t
  chunks() const
  {
    return (points + chunk_points - 1) / chunk_points;
  }

  /** \brief Vertices whose rows a thread takes at a time. */
  static constexpr std::size_t part_rows = 1024;

  /** \brief The runs of some vertices, in each direction of a group: their rows one
   * after the other, the last of a run marked (kernels::run_end). */
  struct Bucket {
    std::vector<std::int32_t> steps;
    /** \brief Of each direction, with an end. After its steps comes one that is not its
     * own, as a loop looks one step ahead. */
    std::vector<std::size_t> begins;
  };

  /** \brief Directions that are blurred one after the other without a look at more than
   * a bucket of vertices, which stays in the fast cache: a bucket holds whole sheets,
   * sets of all vertices that can be reached by steps in these directions. */
  struct Group {
    std::size_t first_direction;
    std::vector<Bucket> buckets;
  };

  kernels::LatticeFrame frame = {}; ///< a vertex lies at its low
  std::size_t points = 0;           ///< N
  std::size_t corners = 0;          ///< of a simplex, d + 1
  std::size_t vertices = 0;
  std::size_t rows = 0; ///< vertices and partial rows
  std::size_t chunk_points = 0;

  std::vector<std::int32_t> columns; ///< of the sorted points
  AlignedArray<std::int32_t> corner_rows;
  AlignedArray<float> weights;

  std::vector<std::size_t> first_rows;     ///< by chunk, with an end
  std::vector<std::size_t> first_partials; ///< by chunk, with an end
  std::vector<std::int32_t> represents;    ///< vertex of each partial row
  std::vector<std::int32_t> merged;        ///< partial rows by part of their vertices
  std::vector<std::size_t> merged_begins;  ///< of parts, with an end

  std::vector<Group> groups;
  Eigen::ArrayXf self_responses; ///< what a one at every point sends back, no gain()
};

} // namespace pcl_semantic
