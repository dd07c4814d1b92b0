// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viewed_map.h"

#include <limits>
#include <set>
#include <string>

namespace pcl_semantic::tool {

/** \brief What of a map is shown, and how; keys change it. */
struct ViewState {
  std::set<Label> hidden;
  std::size_t colouring = 0;                               ///< of the map's
  double below = std::numeric_limits<double>::infinity();  ///< [m]
  double above = -std::numeric_limits<double>::infinity(); ///< [m]
  bool path = true, pictures = false, panel = true, help = false;
  int view = 0; ///< which of the views the camera takes next
  bool is_closed = false;

  /** \brief Whether a voxel is to be seen. */
  bool
  shows(const ViewedMap& map, std::size_t voxel) const
  {
    const double height = map.heightOf(voxel);
    return height < below && height > above && hidden.count(map.labels[voxel]) == 0;
  }
};

/** \brief What has to be drawn anew. */
enum class Redraw { nothing, panel, voxels, camera };

/** \brief Does what a key stands for.
 * \param[in] key as X names it: "m", "3", "Up"
 * \param[in] views how many there are */
Redraw press(const std::string& key, const ViewedMap& map, int views, ViewState& state);

/** \brief Shows a class if it is hidden, hides it if it is shown. */
void toggle(Label label, ViewState& state);

/** \brief The key of a class: its number, 0 for the tenth; none for those behind it. */
std::string keyOf(Label label);

/** \brief A line for each key: what it does. */
const std::vector<std::string>& helpOnKeys();

} // namespace pcl_semantic::tool
