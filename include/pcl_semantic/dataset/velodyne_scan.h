// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Reads a scan of KITTI's Velodyne (`velodyne/\*.bin`: float32 x, y, z,
 * reflectance a point).
 * \return points in the scanner's frame (x forward, y left, z up) [m], intensity =
 * reflectance
 * \throws BadInputException if it holds no points, half a point or a non-finite number
 */
pcl::PointCloud<pcl::PointXYZI>::Ptr readVelodyneScan(const std::string& path);

} // namespace pcl_semantic
