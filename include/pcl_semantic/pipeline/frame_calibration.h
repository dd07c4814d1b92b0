/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/labelling/label_calibration.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

namespace pcl_semantic {

/** \brief Where the points of a frame are: above the ground that its own depths and
 * labels show, or nowhere (all NaN) if they show none.
 * \param[in] cloud organized, camera frame [m]
 * \param[in] distributions L x cloud.size()
 * \param[in] ground the classes of the ground
 * \throws InvalidParameterException if sizes do not fit */
std::vector<PointGeometry> frameGeometry(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                                         const LabelDistributions& distributions,
                                         const std::vector<Label>& ground);

} // namespace pcl_semantic
