// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/sensor_frame.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/map/scan.h>
#include <pcl_semantic/stereo/disparity_estimator.h>

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <chrono>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Seconds of each stage of one frame, in the order they ran. */
class StageTimes {
public:
  /** \brief Runs a stage and keeps its wall time. \return what \a stage returns */
  template <typename Stage>
  auto
  measure(const std::string& name, Stage&& stage)
  {
    const Stopwatch stopwatch{*this, name, Clock::now()};
    return stage();
  }

  const std::vector<std::pair<std::string, double>>&
  seconds() const
  {
    return seconds_;
  }

private:
  using Clock = std::chrono::steady_clock;

  struct Stopwatch {
    StageTimes& times;
    const std::string& name;
    Clock::time_point start;

    ~Stopwatch()
    {
      times.seconds_.emplace_back(
          name, std::chrono::duration<double>(Clock::now() - start).count());
    }
  };

  std::vector<std::pair<std::string, double>> seconds_;
};

/** \brief What became of one frame. */
struct MappedFrame {
  StereoFrame frame;        ///< of a cloud: without images, but that of its camera
  DisparityImage disparity; ///< of each pixel, and how sure it is; of a cloud: empty
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud; ///< camera frame [m], organized
  bool has_colour = true;                       ///< whether its colours mean anything
  LabelDistributions network;    ///< L x pixels (or points), as they were labelled
  LabelDistributions calibrated; ///< L x pixels, what the map gets instead; empty if
                                 ///< there is no calibration
  double domain_shift =
      std::numeric_limits<double>::quiet_NaN(); ///< domainShift() of
                                                ///< the calibration; NaN = not known
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts; ///< of the scan that went into the map
  VoxelCloud voxels; ///< the occupied voxels of the window after this frame
  StageTimes times;
};

} // namespace pcl_semantic
