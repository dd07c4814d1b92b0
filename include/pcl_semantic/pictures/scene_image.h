// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pictures/scene_lines.h>
#include <pcl_semantic/pictures/scene_view.h>
#include <pcl_semantic/pictures/voxel_colours.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Renders voxels as solid, shaded cubes on a light background, with the
 * sensor's path, a ground grid (a scale bar without perspective) and a legend below.
 *
 * Faces are shaded by orientation and darker in corners and behind edges. Rendering at
 * twice the size smooths edges. The image depends neither on the number of threads nor
 * on the order of the voxels.
 * \param[in] path in the world frame of the view; may be empty
 * \param[in] lines as boxLines() gives them; parts behind voxels are left out
 * \return CV_8UC3 (BGR), of the view's width; the legend adds to the height
 * \throws InvalidParameterException if there are no voxels, the number of colours
 * differs, or the camera is inside a voxel */
cv::Mat drawVoxels(const VoxelScene& scene, const VoxelColours& colours,
                   const SceneView& view, const SensorPath& path,
                   const std::vector<SceneLine>& lines = {});

} // namespace pcl_semantic
