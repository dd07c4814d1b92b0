// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/files/atomic_file.h>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Meaning of the field `rgba` of a written map. */
enum class VoxelColour {
  measured, ///< mean colour of the pixels
  classes,  ///< colour of the class, for pcl_viewer
  none      ///< no such field
};

/** \brief Writes the file of writeVoxelCloud() in chunks, so that only one chunk has to
 * be in memory. */
class VoxelCloudWriter {
public:
  /** \brief Optional fields. */
  struct Fields {
    bool object = false; ///< VoxelCloud::objects
    bool plane = false;  ///< VoxelCloud::planes
  };

  /** \param[in] count total number of voxels
   * \param[in] voxel_size [m]
   * \param[in] origin of their points, world frame [m]
   * \throws OutputException if the file cannot be written */
  VoxelCloudWriter(const std::string& path, const LabelSet& label_set,
                   VoxelColour colour, std::size_t count, double voxel_size,
                   const Eigen::Vector3d& origin, Fields fields);

  /** \param[in] is_written selects voxels; empty = all */
  void write(const VoxelCloud& voxels, const std::vector<bool>& is_written = {});

  /** \brief Completes the file, which then appears under its name.
   * \throws InvalidParameterException unless \a count voxels were written
   * \throws OutputException if the file cannot be written */
  void commit();

private:
  AtomicFile file_;
  LabelSet label_set_;
  VoxelColour colour_;
  std::size_t missing_;
  Fields fields_;
  std::vector<std::uint8_t> row_;
};

/** \brief Writes a voxel cloud as binary `.pcd`: fields x y z [m, relative to
 * VoxelCloud::origin] rgba label probability (COUNT L, refined) entropy [nat]
 * observations, and object and plane if VoxelCloud::objects and planes are set. Without
 * measured colour there is no rgba. The comment `# voxel_grid SIZE X Y Z` in the header
 * gives the edge of a voxel and the lower corner of voxel 0 [m]: floor((point - corner)
 * / size) is the index of a point's voxel.
 *
 * \throws OutputException if the file cannot be written */
void writeVoxelCloud(const std::string& path, const VoxelCloud& voxels,
                     const LabelSet& label_set, VoxelColour colour);

} // namespace pcl_semantic
