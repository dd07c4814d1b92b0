// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes a cloud as a binary `.pcd` with x y z rgb, complete or not at all.
 * Organized clouds stay organized; points at NaN keep their index and colour.
 * \param[in] origin that was subtracted from the positions; it is added again, in
 * double precision [m]
 * \throws InvalidParameterException if width x height is not the number of points
 * \throws OutputException if the file cannot be written */
void writeColourCloud(const std::string& path,
                      const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                      const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

} // namespace pcl_semantic
