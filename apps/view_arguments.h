// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "render_options.h"

#include <limits>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief What pcl_semantic_view is asked for. */
struct ViewArguments {
  std::string map, screenshot;
  std::string colour;            ///< empty = the first that the map has
  std::vector<std::string> hide; ///< names of classes
  double below = std::numeric_limits<double>::infinity();  ///< [m]
  double above = -std::numeric_limits<double>::infinity(); ///< [m]
  std::string images;                                      ///< a sequence; empty = none
  std::vector<std::string> keys;                           ///< pressed at the beginning
  bool follow = false;                                     ///< the map is being made
  bool small = false; ///< fewer bytes in the screenshot
  int threads = 0;
  RenderOptions picture;
};

/** \return false if help or version was asked for
 * \throws InvalidParameterException */
bool parseViewArguments(int argc, char** argv, ViewArguments& arguments);

} // namespace pcl_semantic::tool
