// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <opencv2/core/mat.hpp>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The label of the voxel that holds each pixel's own measured point: the way of
 * the paper's released code, and the only one to compare with its figures.
 * \param[in] map the map as it stands
 * \param[in] cloud organized cloud of the frame, camera frame [m]; NaN = no depth
 * \param[in] T_world_camera pose of the frame
 * \param[in] max_depth points with a larger z are not looked up [m]
 * \return CV_8UC1 of the cloud's size; 0 = no depth, or no occupied voxel there
 * \throws InvalidParameterException if the cloud is not organized */
cv::Mat labelsAtDepth(const SemanticVoxelMap& map,
                      const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                      const Eigen::Isometry3d& T_world_camera, double max_depth);

} // namespace pcl_semantic
