// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/labelling/label_calibration.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <optional>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The ground before a camera, as a frame's depths and labels show it: the plane
 * of fitGroundPlane() through points of more than 0.5 in one of its classes.
 * \param[in] cloud organized, camera frame [m]
 * \param[in] distributions L x cloud.size()
 * \param[in] ground the classes of the ground
 * \throws InvalidParameterException if sizes do not fit */
std::optional<Eigen::Hyperplane<double, 3>>
frameGround(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
            const LabelDistributions& distributions, const std::vector<Label>& ground);

/** \brief The features of a frame's points: their colour, and where they are above the
 * ground that its own depths and labels show, if they show one.
 * \param[in] cloud organized, camera frame [m]
 * \param[in] distributions L x cloud.size()
 * \param[in] ground the classes of the ground
 * \throws InvalidParameterException if sizes do not fit */
std::vector<PointFeatures> frameFeatures(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                                         const LabelDistributions& distributions,
                                         const std::vector<Label>& ground);

} // namespace pcl_semantic
