// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/point_features.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <optional>
#include <vector>

namespace pcl_semantic {

/** \brief Colour, and above a ground height, distance, levelness and side of the points
 * of an organized cloud; the same for any number of threads.
 *
 * Normals are those of the differences, five pixels to each side, of the cloud smoothed
 * over 7 x 7 pixels: coarse, but unbothered by the steps of a disparity.
 * \param[in] cloud organized, camera frame [m]; NaN = no depth: colour is known alone
 * \param[in] ground normal towards the camera; nothing: colours are known alone
 * \throws InvalidParameterException if the cloud is not organized */
std::vector<PointFeatures>
cloudFeatures(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
              const std::optional<Eigen::Hyperplane<double, 3>>& ground);

} // namespace pcl_semantic
