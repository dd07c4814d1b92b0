// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A drive of a fleet. */
struct FleetDrive {
  std::string name; ///< of the folder of its submaps
  /// Of pcl_semantic_map, by their names with underscores, in the order of the file:
  /// ("sequence", "kitti/05"); those of the plan first.
  std::vector<std::pair<std::string, std::string>> options;
  std::string corrected_poses; ///< trajectory that places its submaps; empty = none
};

/** \brief The plan of pcl_semantic_fleet (doc/fleet.md). */
struct FleetPlan {
  std::string output; ///< folder
  std::vector<FleetDrive> drives;
};

/** \brief Reads a plan (YAML): `output`, `options` of all drives, and a list `drives`
 * with `name`, `corrected_poses` and options of each.
 * \throws BadInputException with file and line: what is missing or cannot be, a name
 * that is no name of a folder or there twice */
FleetPlan readFleetPlan(const std::string& path);

} // namespace pcl_semantic
