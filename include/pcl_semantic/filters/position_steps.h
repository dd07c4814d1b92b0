// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief One line on positions that lost what they say: the steps of single precision
 * at most points are coarser than a tenth of the points' spacing. Empty if not.
 * \param[in] cloud as it was read from single precision
 * \param[in] name of the cloud, for the line */
std::string doubtOfSteps(const pcl::PointCloud<pcl::PointXYZRGBL>& cloud,
                         const std::string& name);

} // namespace pcl_semantic
