// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_input.h"

#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief What pcl_semantic_export can write. */
enum class ExportFormat {
  octree,
  colour_octree,
  points,
  mesh,
  occupancy,
  traversability,
  statistics
};

/** \brief Arguments of pcl_semantic_export. */
struct ExportArguments {
  std::string map, output;
  ExportFormat format = ExportFormat::points;
  MapHints hints;
  bool measured_colours = false; ///< else those of the classes
  /// Names of classes; empty = usual ones, as far as the label set has them.
  std::vector<std::string> ground, traversable;
  double min_height = 0.3, max_height = 2.0, reach = 5.0; ///< [m]
};

/** \return false if only the help or the version was wanted
 * \throws InvalidParameterException */
bool parseExportArguments(int argc, char** argv, ExportArguments& arguments);

} // namespace pcl_semantic::tool
