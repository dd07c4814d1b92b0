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

/** \brief The permutohedral lattice of Adams, Baek and Davis (2010) around N points,
 * with which LatticeKernel approximates sums with the Gaussian exp(-|f_i - f_j|^2 / 2)
 * in time linear in N.
 *
 * Values are splatted to the vertices of the simplex around their point, blurred with
 * the taps 1/2 1 1/2 along every direction in turn, and sliced at the points. Only
 * vertices of a simplex around a point exist. Values that would pass through other
 * vertices are lost, and which ones depends on the order of the directions. The lattice
 * is placed relative to the minimum of the features, so translating all features
 * changes nothing.
 *
 * The points are sorted into chunks of neighbours. Vertices are numbered by the first
 * chunk that uses them, so that a chunk accumulates into its own rows: those of its
 * vertices, and partial rows (numbered after the vertices) for vertices of earlier
 * chunks. Numbers do not depend on the threads. */
struct PermutohedralLattice {
  /** \param[in] features d x N, divided by their deviations; d is 1 to 16
   * \param[in] tier instructions to use; for tests
   * \param[in] lows minimum of each feature in a set of which these points are a part:
   * the lattice then has the vertices of that of the set; empty = of these points
   * \throws InvalidParameterException if a feature is not finite, d is not 1 to 16, or
   * features span too many deviations for unique vertex keys (128 bits). The limit is
   * at least 50 for d = 16 and larger for smaller d. */
  explicit PermutohedralLattice(const Eigen::Ref<const Eigen::MatrixXf>& features,
                                SimdTier tier = simdTier(),
                                const Eigen::VectorXf& lows = {});

  /** \brief Scale of the lattice's sums: the integral of the Gaussian divided by that
   * of splat, blur and slice. */
  float gain() const;

  std::size_t
  chunks() const
  {
    return (points + chunk_points - 1) / chunk_points;
  }

  /** \brief Rows of vertices per task of a thread. */
  static constexpr std::size_t part_rows = 1024;

  /** \brief The runs of some vertices, in each direction of a group: their consecutive
   * rows, the last of a run marked (kernels::run_end). */
  struct Bucket {
    std::vector<std::int32_t> steps;
    /** \brief Begins of each direction, with an end. One foreign step follows the steps
     * of a direction, because a loop reads one step ahead. */
    std::vector<std::size_t> begins;
  };

  /** \brief Directions that are blurred one after the other within a bucket of
   * vertices, which stays in the cache. A bucket contains whole sheets, sets of all
   * vertices reachable by steps in these directions. */
  struct Group {
    std::size_t first_direction;
    std::vector<Bucket> buckets;
  };

  kernels::LatticeFrame frame = {}; ///< a vertex lies at its minimum
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
  std::vector<std::int32_t> merged;        ///< partial rows, by part of their vertices
  std::vector<std::size_t> merged_begins;  ///< of parts, with an end

  std::vector<Group> groups;
  Eigen::ArrayXf self_responses; ///< response of each point to a one at itself, without
                                 ///< gain()
};

} // namespace pcl_semantic
