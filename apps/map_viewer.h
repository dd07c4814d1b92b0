// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewed_map.h"

#include <pcl_semantic/pictures/scene_view.h>

#include <functional>
#include <memory>

namespace pcl_semantic::tool {

/** \brief A window on a map, or a picture of what it would show; PCLVisualizer's, with
 * keys of its own. There has to be a display: VTK aborts without one. */
class MapViewer {
public:
  MapViewer(const std::string& title, cv::Size size, bool off_screen);
  ~MapViewer();

  /** \brief Shows a map in place of the one before.
   * \param[in] views that the camera can take, in the frame of the map's indices; if
   * there was no map before, it takes the first */
  void show(ViewedMap map, std::vector<SceneView> views);

  /** \brief Moves the camera, and what it looks at [m]. */
  void move(const Eigen::Vector3d& step);

  /** \brief State of the view, from the next map or key on. */
  ViewState& state();

  /** \brief Does what a key does. */
  void press(const std::string& key);

  /** \brief Picture of the window: CV_8UC3 (BGR). */
  cv::Mat picture();

  /** \brief Has the window until it is closed or the program is to end.
   * \param[in] tick called ten times a second */
  void run(const std::function<void()>& tick);

private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

} // namespace pcl_semantic::tool
