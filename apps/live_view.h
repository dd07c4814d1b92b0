/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "viewed_map.h"

#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <string>

namespace pcl_semantic::tool {

/** \brief A window on a map in the making: pcl_semantic_view, started as a program of
 * its own. Nothing that happens to a window, to its X server or to what draws touches
 * the map, and who has no window does not load what draws. */
class LiveView {
public:
  /** \brief Opens the window.
   * \throws InvalidParameterException with its own words if it does not open */
  LiveView(StereoCamera camera, LabelSet label_set);
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /** \brief Shows the voxels of the window after a frame, its left image, and the path
   * of the camera. */
  void show(const MappedFrame& mapped);

  /** \brief Shows the whole map; it can be looked at when this program has ended. */
  void finish(const SemanticVoxelMap& map);

private:
  void send(const ViewedMap& map);

  StereoCamera camera_;
  LabelSet label_set_;
  Trajectory path_; ///< of the left camera, world frame [m]
  int socket_ = -1; ///< -1: the window is closed
};

} // namespace pcl_semantic::tool
