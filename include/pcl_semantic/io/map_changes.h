// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/io/archive_merge.h>

#include <cstddef>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Where two maps contradict each other. */
struct MapChanges {
  VoxelCloud voxels; ///< as the map has them that saw them occupied: first those that
                     ///< went (red), then those that came (green)
  std::size_t went = 0; ///< occupied before, free after
  std::size_t came = 0; ///< the other way round
};

/** \brief The voxels that one map has seen occupied and the other free, and with them
 * all the voxels around: what is a voxel off is a matter of measuring.
 * \param[in] before, after archives that merge (mergeArchives()): of one voxel size,
 * label set and fusion
 * \throws BadInputException that says what differs, or if one is damaged */
MapChanges findChanges(const PlacedArchive& before, const PlacedArchive& after);

} // namespace pcl_semantic
