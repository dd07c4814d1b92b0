// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/frame_time.h>
#include <pcl_semantic/core/label_distributions.h>

#include <opencv2/core/mat.hpp>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cstddef>
#include <string>
#include <variant>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief One rectified stereo pair. */
struct StereoFrame : FrameTime {
  cv::Mat left;  ///< CV_8UC3 (BGR) or CV_8UC1
  cv::Mat right; ///< the same type as \a left
};

/** \brief A colour image with the depths of its pixels. */
struct RgbdFrame : FrameTime {
  cv::Mat image; ///< CV_8UC3 (BGR)
  /// Camera frame (x right, y down, z forward) [m], organized and coloured as the
  /// image; NaN where a pixel has no depth.
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud;
  std::size_t unmeasured = 0; ///< pixels without a measurement
};

/** \brief A cloud taken at one time from one position, with its labels. */
struct CloudFrame : FrameTime {
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud; ///< sensor frame [m]
  LabelDistributions distributions;             ///< L x points; empty: no labels
  bool has_colour = false; ///< false: the cloud's colours are undefined
  /// T_world_sensor from the file (VIEWPOINT of a .pcd).
  Eigen::Isometry3d viewpoint = Eigen::Isometry3d::Identity();
  std::string path{};                ///< path of its file; empty = none
  std::vector<std::string> doubts{}; ///< about its file, a line each
};

/** \brief A frame of a sensor. */
using SensorFrame = std::variant<StereoFrame, RgbdFrame, CloudFrame>;

/** \brief Number and time of a frame. */
inline const FrameTime&
timeOf(const SensorFrame& frame)
{
  return std::visit([](const FrameTime& each) -> const FrameTime& { return each; },
                    frame);
}

} // namespace pcl_semantic
