/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "map_input.h"

#include <opencv2/core/types.hpp>

#include <string>

namespace pcl_semantic::tool {

/** \brief What pcl_semantic_render is asked for. */
struct RenderArguments {
  std::string map, output;
  std::string compare; ///< another map; empty = none
  std::string view = "angle", colour = "class";
  cv::Size size;                 ///< [px]
  bool looks_from = false;       ///< whether the next two are given
  Eigen::Vector3d from, look_at; ///< as the cloud's points [m]
  double field_of_view = 0.0;    ///< over the width [rad]
  int frame = 0, threads = 0;
  bool small = false;
  MapHints hints;
};

/** \return false if help or version was asked for
 * \throws InvalidParameterException */
bool parseRenderArguments(int argc, char** argv, RenderArguments& arguments);

} // namespace pcl_semantic::tool
