// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_arguments.h"

#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <memory>
#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief Where the labels of a run come from. */
struct Labelling {
  LabelSet label_set;
  std::unique_ptr<LabelPredictor> predictor;
  std::string model; ///< path; empty without a network
};

/** \throws BadInputException, BadModelException */
Labelling makeLabelling(const MapArguments& arguments);

/** \brief What labels and cliques are worth, as far as it is given. */
struct Calibrations {
  std::optional<LabelCalibration> labels, cliques;
};

/** \throws BadInputException */
Calibrations readCalibrations(const MapArguments& arguments, const LabelSet& label_set);

void setCalibrations(const Calibrations& calibrations, SemanticMapper& mapper);

} // namespace pcl_semantic::tool
