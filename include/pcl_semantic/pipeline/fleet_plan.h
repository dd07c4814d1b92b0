// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/map_inputs.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A drive of a fleet. */
struct FleetDrive {
  std::string name; ///< name of the folder of its submaps
  MapInputs inputs;
  MapperConfig config;
  std::string submap_every = "50m"; ///< see parseSubmapLength()
  std::string corrected_poses; ///< trajectory that positions its submaps; empty = none
};

/** \brief The plan of pcl_semantic_fleet (doc/fleet.md). */
struct FleetPlan {
  std::string output; ///< folder
  std::vector<FleetDrive> drives;
};

/** \brief Reads a plan (YAML): `output`, `options` of all drives, and a list `drives`
 * with `name`, `corrected_poses` and options of each drive. Options are the inputs of a
 * map (MapInputs), its parameters, `submap_every`, and `config`, a parameter file
 * relative to the plan, which the other options override.
 * \throws BadInputException with file and line at a missing key, an unknown option, an
 * invalid value, or a name that is invalid for a folder or not unique */
FleetPlan readFleetPlan(const std::string& path);

} // namespace pcl_semantic
