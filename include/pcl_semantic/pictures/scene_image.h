// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pictures/scene_view.h>
#include <pcl_semantic/pictures/voxel_colours.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Draws voxels as solid, shaded cubes on a light background, with the sensor's
 * path, a grid on the ground (a scale without perspective) and a legend below.
 *
 * Faces are lit by their orientation, darker in corners and behind edges, so that
 * shapes read; sides are smoothed by drawing twice as large. Neither the number of
 * threads nor the order of the voxels changes a pixel.
 * \param[in] path in the world of the view; may be empty
 * \return CV_8UC3 (BGR), of the view's width, higher than it by the legend
 * \throws InvalidParameterException if there are no voxels, as many colours as voxels
 * are not given, or the camera is inside a voxel */
cv::Mat drawVoxels(const VoxelScene& scene, const VoxelColours& colours,
                   const SceneView& view, const SensorPath& path);

} // namespace pcl_semantic
