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

/** \brief The plane of the ground before a camera, its normal towards the camera: least
 * squares with Cauchy weights of 5 cm, begun from the median height, so that kerbs and
 * what is wrongly called ground hardly count.
 * \param[in] cloud camera frame (x right, y down, z forward) [m]
 * \param[in] is_ground of each point, 0 = no
 * \param[in] max_distance points with a larger z do not count: their depth is noise [m]
 * \return nothing if fewer than 200 points of the ground lie there, or the plane is
 * more than 30 degrees off the camera's own level
 * \throws InvalidParameterException if the sizes differ */
std::optional<Eigen::Hyperplane<double, 3>>
fitGroundPlane(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
               const std::vector<std::uint8_t>& is_ground, double max_distance = 25.0);

/** \brief Direction to the right of a camera along the ground, unit length.
 * \param[in] ground normal towards the camera, camera frame */
Eigen::Vector3d rightAlong(const Eigen::Hyperplane<double, 3>& ground);

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
