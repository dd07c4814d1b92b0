// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What a map holds of one class. */
struct ClassStatistics {
  Label label = kUnlabelled;
  std::size_t voxels = 0;
  double fraction = 0.0; ///< of all voxels, 0 to 1
  double volume = 0.0;   ///< [m^3]
  double area = 0.0;     ///< seen from above: columns that hold the class [m^2]
  double mean_z = 0.0; ///< of the voxels' centres, world frame [m]; NaN without voxels
  double lowest_z = 0.0;  ///< likewise
  double highest_z = 0.0; ///< likewise
};

/** \brief Counts the voxels of each label from 0 (unlabelled) to L.
 * \throws InvalidParameterException at a label beyond the label set */
std::vector<ClassStatistics> countClasses(const VoxelScene& scene,
                                          const LabelSet& label_set);

/** \brief Writes them as `.csv`: a line of names, then a line a label; heights of a
 * class without voxels are empty. \throws OutputException */
void writeClassStatistics(const std::string& path,
                          const std::vector<ClassStatistics>& statistics,
                          const LabelSet& label_set);

} // namespace pcl_semantic
