// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_viewer.h"
#include "view_arguments.h"

#include <memory>

namespace pcl_semantic::tool {

/** \brief A map, from where it can be seen, and what of it is shown. */
struct OpenedMap {
  ViewedMap map;
  std::vector<PictureView> views;
  ViewState state;
};

/** \brief Reads the map that is asked for.
 * \throws BadInputException, InvalidParameterException */
OpenedMap openMap(const ViewArguments& arguments);

/** \brief Shows the maps that come on standard input. */
class LiveShow {
public:
  LiveShow(const ViewArguments& arguments, MapViewer& viewer);
  ~LiveShow();

  /** \brief Tells who sends that the window is open, and begins to read: whatever
   * comes, so that nobody waits for the window. From now on nothing is printed. */
  void sayReady();

  /** \brief Shows the newest that has come since. */
  void showNewest();

  /** \brief Waits for the end and shows the last.
   * \throws BadInputException if none came */
  void showLast();

private:
  struct Inbox;

  void show(ViewedMap map);
  std::vector<PictureView> viewsOf(const ViewedMap& map) const;

  const ViewArguments& arguments_;
  MapViewer& viewer_;
  std::shared_ptr<Inbox> inbox_;
  bool is_first_ = true;
  Eigen::Vector3d last_place_ = Eigen::Vector3d::Zero(); ///< of the camera
};

} // namespace pcl_semantic::tool
