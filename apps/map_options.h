// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/pipeline/map_inputs.h>
#include <pcl_semantic/pipeline/map_run.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <string>

namespace pcl_semantic::tool {

/** \brief Programs with the same command line. */
enum class MapProgram { map, live };

/** \brief The command line of pcl_semantic_map, or of pcl_semantic_live. */
struct MapOptions {
  MapInputs inputs;
  MapperConfig config;
  MapOutputs outputs;
  bool view = false;        ///< open a window, see openLiveView()
  bool every_frame = false; ///< pcl_semantic_live: map two videos frame by frame
  std::string submap_every; ///< see parseSubmapLength(); empty = one map
};

/** \brief Parses and checks the command line.
 * \throws InvalidParameterException, BadInputException
 * \throws Exit as parseCommandLine(), and after `--print-config` */
MapOptions parseMapOptions(int argc, char** argv, MapProgram program);

} // namespace pcl_semantic::tool
