// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lattice_structure.h"

namespace pcl_semantic {

/** \brief Numbers 0 ... count - 1 sorted by their bucket, those of one bucket in their
 * order. */
struct LatticeBuckets {
  LatticeArray<std::int32_t> members;
  std::vector<std::size_t> begins; ///< of each bucket, with an end

  LatticeBuckets(const LatticeArray<std::int32_t>& bucket_of, std::size_t buckets);
};

/** \brief The least features and the extents from there to the largest.
 * \throws InvalidParameterException as buildLattice() */
kernels::LatticeFrame frameOf(const LatticeFeatures& features, double* extents);

/** \brief An order in which points that lie together follow each other: tiles of the
 * first two features (an image's pixels would come row by row), where those of a tile
 * keep their order. */
LatticeArray<std::int32_t> orderInTiles(const LatticeFeatures& features,
                                        const kernels::LatticeFrame& frame,
                                        const double* extents);

} // namespace pcl_semantic
