// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_cloud.h>

#include <opencv2/core/mat.hpp>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Overlays the camera's image with the classes of the map, and adds a legend of
 * those in the image. It is as high as one of all classes, up to three rows, so that
 * the pictures of a sequence have one size.
 * \param[in] image CV_8UC3 (BGR) or CV_8UC1
 * \param[in] labels CV_8UC1 of the same size; 0 shows the image in grey
 * \throws InvalidParameterException if the sizes differ */
cv::Mat drawOverlay(const cv::Mat& image, const cv::Mat& labels,
                    const LabelSet& label_set);

/** \brief Renders a map from above: each column of voxels in the class of its highest
 * labelled voxel, lighter with height; the sensor's path in red, a scale bar, a legend
 * of the classes in the map. A map without classes is drawn in its own colours.
 * World x (forward) points up, y (left) to the left.
 * \param[in] path positions of the sensor, world frame [m] */
cv::Mat drawTopView(const VoxelCloud& voxels, const std::vector<Eigen::Vector3d>& path,
                    const LabelSet& label_set);

} // namespace pcl_semantic
