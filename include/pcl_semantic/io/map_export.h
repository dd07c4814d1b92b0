// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/map_reader.h>
#include <pcl_semantic/io/voxel_cloud_file.h>
#include <pcl_semantic/things/object_summary.h>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

struct VoxelSelection {
  /// Contains the voxel centres, lower faces included, upper ones not; world frame [m].
  Eigen::AlignedBox3d box{Eigen::Vector3d::Constant(-1e300),
                          Eigen::Vector3d::Constant(1e300)};
  std::vector<Label> labels; ///< MAP labels, kUnlabelled too; empty = any
};

struct ArchiveExtent {
  std::size_t voxels = 0;  ///< number of occupied voxels
  Eigen::AlignedBox3d box; ///< box around these voxels, world frame [m]; empty if there
                           ///< are none
};

/** \brief Counts the occupied voxels and computes their extent. Reads the whole
 * archive. */
ArchiveExtent archiveExtent(const MapReader& archive,
                            const BlockProgress& progress = nullptr);

/** \brief Reads the selected occupied voxels, without distributions and observations.
 * Memory: the selected voxels and one block.
 * \throws BadInputException if the archive is damaged */
VoxelCloud readVoxels(const MapReader& archive, const VoxelSelection& selection);

/** \brief Describes the objects of a map, as ObjectTracker::summarize(). Memory: the
 * voxels of objects and one block.
 * \param[in] selection other voxels are left out
 * \throws BadInputException if the archive is damaged */
std::vector<ObjectSummary> describeObjects(const MapReader& archive,
                                           const VoxelSelection& selection = {});

/** \brief Writes occupied voxels as writeVoxelCloud() does; for the whole map, with its
 * planes, the files are identical. Memory: one block and the objects. Reads the
 * archive twice.
 *
 * \param[in] planes of the selected voxels, in the order of readVoxels(); null = no
 * field `plane`
 * \return number of voxels
 * \throws BadInputException if the archive is damaged
 * \throws OutputException if the file cannot be written */
std::size_t exportVoxels(const MapReader& archive, const VoxelSelection& selection,
                         const std::string& path,
                         VoxelColour colour = VoxelColour::measured,
                         const BlockProgress& progress = nullptr,
                         const std::vector<std::uint32_t>* planes = nullptr);

} // namespace pcl_semantic
