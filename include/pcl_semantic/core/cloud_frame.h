// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/stereo_frame.h>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <variant>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What a sensor saw at one moment, from one place, and what is known of it. */
struct CloudFrame {
  int number = 0;         ///< frame number of the sequence; may have gaps
  double timestamp = 0.0; ///< [s]
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud; ///< sensor frame [m]
  LabelDistributions distributions; ///< L x points, or empty: a cloud without labels
  bool has_colour = false;          ///< whether the cloud's colours mean anything
};

/** \brief What a sensor gives at one moment: a pair of images or a cloud. */
using SensorFrame = std::variant<StereoFrame, CloudFrame>;

} // namespace pcl_semantic
