// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewed_map.h"

#include <pcl_semantic/pictures/scene_view.h>

#include <functional>
#include <memory>

namespace pcl_semantic::tool {

/** \brief A window on a map, or an image of it; a PCLVisualizer with its own keys. It
 * requires a display, because VTK aborts without one. */
class MapViewer {
public:
  MapViewer(const std::string& title, cv::Size size, bool off_screen);
  ~MapViewer();

  /** \brief Shows a map instead of the previous one.
   * \param[in] views of the camera, in the frame of the map's indices; the first map
   * uses the first view */
  void show(ViewedMap map, std::vector<SceneView> views);

  /** \brief Moves the camera and its focus [m]. */
  void move(const Eigen::Vector3d& step);

  /** \brief State of the view, used from the next map or key on. */
  ViewState& state();

  /** \brief Handles a key. */
  void press(const std::string& key);

  /** \brief Renders the window: CV_8UC3 (BGR). */
  cv::Mat picture();

  /** \brief Runs the window until it is closed or the program is interrupted.
   * \param[in] tick called ten times per second */
  void run(const std::function<void()>& tick);

private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

} // namespace pcl_semantic::tool
