// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/point_features.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Fits the ground plane in front of a camera, its normal towards the camera:
 * least squares with Cauchy weights of 5 cm, started at the median height, so that
 * kerbs and wrongly labelled points have little influence.
 * \param[in] cloud camera frame (x right, y down, z forward) [m]
 * \param[in] is_ground one flag per point
 * \param[in] max_distance points with a larger z are ignored: their depth is noise [m]
 * \return nothing if there are fewer than 200 ground points, or the plane is inclined
 * by more than 30 degrees to the camera's horizontal plane
 * \throws InvalidParameterException if the sizes differ */
std::optional<Eigen::Hyperplane<double, 3>>
fitGroundPlane(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
               const std::vector<std::uint8_t>& is_ground, double max_distance = 25.0);

/** \brief Computes colour features and, relative to the ground, height, distance, level
 * and side of the points of an organized cloud. The result does not depend on the
 * number of threads.
 *
 * Normals come from differences over five pixels to each side in the cloud smoothed
 * over 7 x 7 pixels: coarse, but insensitive to disparity quantisation.
 * \param[in] cloud organized, camera frame [m]; NaN = no depth: only colour features
 * \param[in] ground normal towards the camera; nothing: only colour features
 * \throws InvalidParameterException if the cloud is not organized */
std::vector<PointFeatures>
cloudFeatures(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
              const std::optional<Eigen::Hyperplane<double, 3>>& ground);

} // namespace pcl_semantic
