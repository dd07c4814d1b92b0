/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "map_arguments.h"

#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/labelling/label_predictor.h>

#include <memory>
#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief Where the labels of a run come from. */
struct Labelling {
  LabelSet label_set;
  std::unique_ptr<LabelPredictor> predictor;
  std::string model; ///< path; empty without a network
  std::optional<LabelCalibration> calibration{};
  std::optional<LabelCalibration> clique_calibration{};
};

/** \throws BadInputException, BadModelException */
Labelling makeLabelling(const MapArguments& arguments);

} // namespace pcl_semantic::tool
