// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/point_features.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Computes the features of a frame's points: colour, and position relative to
 * the ground, if it is found: the plane of fitGroundPlane() through points with a
 * probability above 0.5 for a ground class.
 * \param[in] cloud organized, camera frame [m]
 * \param[in] distributions L x cloud.size()
 * \param[in] ground the classes of the ground
 * \throws InvalidParameterException if sizes do not fit */
std::vector<PointFeatures> frameFeatures(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                                         const LabelDistributions& distributions,
                                         const std::vector<Label>& ground);

} // namespace pcl_semantic
