// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/io/voxel_scene.h>
#include <pcl_semantic/pictures/drawing.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

struct VoxelColours {
  std::vector<cv::Vec3b> colours; ///< one per voxel: blue, green, red
  std::vector<LegendEntry> legend;
  std::string note;     ///< a caption line; may be empty
  double shading = 1.0; ///< strength of shading, 0 to 1
};

/** \brief Colours of the classes; the legend lists the classes in the scene.
 * \throws InvalidParameterException for a label beyond the label set */
VoxelColours classColours(const VoxelScene& scene, const LabelSet& label_set);

/** \brief The measured colours. \throws InvalidParameterException if there are none */
VoxelColours measuredColours(const VoxelScene& scene);

/** \brief Uncertainty of the labels: entropy from 0 (pale) to log L (dark).
 * \throws InvalidParameterException if the scene has no distributions */
VoxelColours entropyColours(const VoxelScene& scene);

/** \brief Voxels whose label changed in the colour of the new class, all others grey.
 * \param[in] before previous label of each voxel, 0 = none: not compared
 * \throws InvalidParameterException for another number of labels */
VoxelColours changeColours(const VoxelScene& scene, const std::vector<Label>& before,
                           const LabelSet& label_set);

} // namespace pcl_semantic
