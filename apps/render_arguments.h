// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "picture_options.h"

#include <string>

namespace pcl_semantic::tool {

/** \brief What pcl_semantic_render is asked for. */
struct RenderArguments {
  std::string map, output;
  std::string compare; ///< another map; empty = none
  std::string colour = "class";
  int threads = 0;
  bool small = false;
  PictureOptions picture;
};

/** \return false if help or version was asked for
 * \throws InvalidParameterException */
bool parseRenderArguments(int argc, char** argv, RenderArguments& arguments);

} // namespace pcl_semantic::tool
