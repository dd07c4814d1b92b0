// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "aligned_array.h"
#include "core/simd.h"
#include "kernels/lattice_building.h"

#include <pcl_semantic/core/abi_check.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief The runs of some vertices, in each direction of a group: their rows one after
 * the other, the last of a run marked. */
struct LatticeBucket {
  std::vector<std::int32_t> steps;
  std::vector<std::uint32_t> begins; ///< of each direction
  std::vector<std::uint32_t> counts; ///< of each direction
};

/** \brief Directions that are blurred one after the other without a look at more than a
 * bucket of vertices, which stays in the fast cache: a bucket holds whole sheets, sets
 * of all vertices that can be reached by steps in these directions. */
struct LatticeGroup {
  int first_direction = 0;
  std::vector<LatticeBucket> buckets;
};

/** \brief A lattice around points. The points are sorted into chunks that lie together.
 * Vertices are numbered by the chunk that touches them first, so that the sums of a
 * chunk go to rows of its own: those of its vertices, and partial rows (numbered after
 * the vertices) for those of earlier chunks. No number depends on the threads. */
struct LatticeStructure {
  kernels::LatticeFrame frame = {};
  std::size_t points = 0;
  std::size_t corners = 0; ///< of a simplex, d + 1
  std::size_t vertices = 0;
  std::size_t rows = 0; ///< vertices and partial rows
  std::size_t chunk_points = 0;

  AlignedArray<std::int32_t> columns; ///< of the sorted points
  AlignedArray<std::int32_t> corner_rows;
  AlignedArray<float> weights;
  std::vector<std::int32_t> row_ends; ///< of own rows begun, every 64 points

  std::vector<std::size_t> first_rows;     ///< by chunk, with an end
  std::vector<std::size_t> first_partials; ///< by chunk, with an end
  AlignedArray<std::int32_t> represents;   ///< vertex of each partial row

  std::vector<std::int32_t> shared;       ///< vertices with partial rows
  std::vector<std::uint32_t> shared_ends; ///< of their partial rows, after a 0
  std::vector<std::int32_t> shared_rows;  ///< those

  std::vector<LatticeGroup> groups;
  AlignedArray<float> self_responses; ///< by column

  std::size_t
  chunks() const
  {
    return (points + chunk_points - 1) / chunk_points;
  }
};

/** \brief Builds the lattice around the columns of features.
 * \throws InvalidParameterException if a feature is not finite, there are none or more
 * than 16 a point, or they span too many deviations for the keys of the vertices */
LatticeStructure buildLattice(const Eigen::Ref<const Eigen::MatrixXf>& features,
                              SimdTier tier);

} // namespace pcl_semantic
