// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewed_map.h"

#include <pcl_semantic/pipeline/run_description.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <string>

namespace pcl_semantic::tool {

/** \brief A window on a map in the making: pcl_semantic_view, started as a program of
 * its own. Nothing that happens to a window, to its X server or to what draws touches
 * the map, and who has no window does not load what draws. */
class LiveView {
public:
  /** \brief Opens the window.
   * \param[in] run what is mapped; without a camera the frames are those of clouds
   * \throws InvalidParameterException with its own words if it does not open */
  explicit LiveView(const MappingRun& run);
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /** \brief Shows the voxels of the window after a frame, its left image if it has one,
   * and the path of the camera, or of the sensor as one that looks along its x. */
  void show(const MappedFrame& mapped);

  /** \brief Shows the whole map; it can be looked at when this program has ended. */
  void finish(const SemanticVoxelMap& map);

private:
  void send(const ViewedMap& map);

  StereoCamera camera_;
  Eigen::Isometry3d T_sensor_camera_ = Eigen::Isometry3d::Identity();
  LabelSet label_set_;
  Trajectory path_; ///< of the left camera, world frame [m]
  int socket_ = -1; ///< -1: the window is closed
};

} // namespace pcl_semantic::tool
