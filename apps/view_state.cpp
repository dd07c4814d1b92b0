// SPDX-License-Identifier: BSD-3-Clause
#include "view_state.h"

#include <algorithm>
#include <cmath>

namespace pcl_semantic::tool {

namespace {

// The lowest and the highest centre of a voxel [m].
std::pair<double, double>
heightsOf(const ViewedMap& map)
{
  std::pair<double, double> heights(std::numeric_limits<double>::infinity(),
                                    -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < map.indices.size(); ++i) {
    heights.first = std::min(heights.first, map.heightOf(i));
    heights.second = std::max(heights.second, map.heightOf(i));
  }
  return heights;
}

// Moves a limit by so many layers of voxels, from the end of the map if there was none.
Redraw
moveLimit(const ViewedMap& map, int layers, double& limit)
{
  if (map.indices.empty())
    return Redraw::nothing;
  const auto [low, high] = heightsOf(map);
  const double half = 0.5 * map.grid.size;
  limit = std::clamp(limit, low - half, high + half) + layers * map.grid.size;
  return Redraw::voxels;
}

Redraw
toggleAll(const ViewedMap& map, ViewState& state)
{
  if (!state.hidden.empty()) {
    state.hidden.clear();
    return Redraw::voxels;
  }
  for (const ViewedClass& each : map.classes)
    state.hidden.insert(each.label);
  return Redraw::voxels;
}

Redraw
flip(bool& flag)
{
  flag = !flag;
  return Redraw::panel;
}

} // namespace

Redraw
press(const std::string& key, const ViewedMap& map, int views, ViewState& state)
{
  for (const ViewedClass& each : map.classes)
    if (key == keyOf(each.label)) {
      toggle(each.label, state);
      return Redraw::voxels;
    }
  if (key == "a")
    return toggleAll(map, state);
  if (key == "m") {
    state.colouring = (state.colouring + 1) % map.colourings.size();
    return Redraw::voxels;
  }
  if (key == "Up" || key == "Down")
    return moveLimit(map, key == "Up" ? 2 : -2, state.below);
  if (key == "Prior" || key == "Next")
    return moveLimit(map, key == "Prior" ? 2 : -2, state.above);
  if (key == "Home") {
    state.below = std::numeric_limits<double>::infinity();
    state.above = -state.below;
    return Redraw::voxels;
  }
  if (key == "v" || key == "r") {
    state.view = key == "r" || views == 0 ? 0 : (state.view + 1) % views;
    return Redraw::camera;
  }
  if (key == "q" || key == "Escape")
    return flip(state.is_closed);
  return key == "t"   ? flip(state.path)
         : key == "i" ? flip(state.pictures)
         : key == "l" ? flip(state.panel)
         : key == "h" ? flip(state.help)
                      : Redraw::nothing;
}

void
toggle(Label label, ViewState& state)
{
  if (state.hidden.erase(label) == 0)
    state.hidden.insert(label);
}

std::string
keyOf(Label label)
{
  return label >= 1 && label <= 10 ? std::to_string(label % 10) : "";
}

const std::vector<std::string>&
helpOnKeys()
{
  static const std::vector<std::string> lines = {
      "1 ... 9, 0: a class on, off",
      "click on a name: likewise",
      "a: all classes on, off",
      "m: next colouring",
      "Down, Up: ceiling lower, higher",
      "Page Down, Page Up: the floor",
      "Home: neither of them",
      "t: path of the camera",
      "i: pictures of the camera",
      "v: next view; r: the first",
      "l: this panel; h: these lines",
      "mouse: turn; Shift: move; wheel: zoom",
      "q: close"};
  return lines;
}

} // namespace pcl_semantic::tool
