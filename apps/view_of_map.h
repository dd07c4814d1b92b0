// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_viewer.h"
#include "view_arguments.h"

#include <filesystem>
#include <string>

namespace pcl_semantic::tool {

/** \brief A map, from where it can be seen, and what of it is shown. */
struct OpenedMap {
  ViewedMap map;
  std::vector<SceneView> views;
  ViewState state;
};

/** \brief Reads the map that is asked for.
 * \throws BadInputException, InvalidParameterException */
OpenedMap openMap(const ViewArguments& arguments);

/** \brief Shows the map of a folder while pcl_semantic_map --view writes to it: what is
 * around the sensor after each frame, and at the end the whole. */
class FollowedMap {
public:
  FollowedMap(const ViewArguments& arguments, MapViewer& viewer);

  /** \brief Shows the map if it has changed. */
  void update();

private:
  void show(OpenedMap opened);

  ViewArguments arguments_;
  MapViewer& viewer_;
  const std::string folder_;
  std::filesystem::file_time_type shown_; ///< when that map was written
  bool is_first_ = true;
  Eigen::Vector3d last_position_ = Eigen::Vector3d::Zero(); ///< of the camera
};

} // namespace pcl_semantic::tool
