// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/frame_time.h>
#include <pcl_semantic/core/label_distributions.h>

#include <opencv2/core/mat.hpp>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <variant>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief One rectified stereo pair. */
struct StereoFrame : FrameTime {
  cv::Mat left;  ///< CV_8UC3 (BGR) or CV_8UC1
  cv::Mat right; ///< as left
};

/** \brief A cloud taken at one time from one position, with its labels. */
struct CloudFrame : FrameTime {
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud; ///< sensor frame [m]
  LabelDistributions distributions;             ///< L x points; empty: no labels
  bool has_colour = false; ///< false: the cloud's colours are undefined
  /// T_world_sensor from the file (VIEWPOINT of a .pcd).
  Eigen::Isometry3d viewpoint = Eigen::Isometry3d::Identity();
};

using SensorFrame = std::variant<StereoFrame, CloudFrame>;

inline const FrameTime&
timeOf(const SensorFrame& frame)
{
  return std::visit([](const FrameTime& each) -> const FrameTime& { return each; },
                    frame);
}

} // namespace pcl_semantic
