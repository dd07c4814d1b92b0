// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/io/archive_merge.h>

#include <cstddef>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The voxels in which two maps contradict each other. */
struct MapChanges {
  VoxelCloud voxels;    ///< from the map in which they are occupied: first the removed
                        ///< voxels (red), then the added ones (green)
  std::size_t went = 0; ///< number of voxels occupied before, free after
  std::size_t came = 0; ///< number of voxels free before, occupied after
};

/** \brief Finds the voxels that are occupied in one map while they and all their
 * neighbours are free in the other: a shift by one voxel is within measurement
 * accuracy.
 * \param[in] before, after archives that can be merged (mergeArchives()): same voxel
 * size, label set and fusion
 * \throws BadInputException that names the difference, or if an archive is damaged */
MapChanges findChanges(const PlacedArchive& before, const PlacedArchive& after);

} // namespace pcl_semantic
