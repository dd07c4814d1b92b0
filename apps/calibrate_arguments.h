// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tool.h"

#include <pcl_semantic/labelling/calibration_fit.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief What pcl_semantic_calibrate is asked for. */
struct CalibrateArguments {
  std::vector<std::string> sequences;
  std::string labels, truth, label_set, output;
  std::string ground = "road,sidewalk";
  std::string clique_config, label_calibration, features;
  MapperConfig config;
  std::string frames = ":";
  CalibrationOptions fit;
};

extern const Usage calibrate_usage;

/** \brief Reads the command line; usage errors end the program.
 * \return false if only help was asked for */
bool parseArguments(int argc, char** argv, CalibrateArguments& arguments);

} // namespace pcl_semantic::tool
