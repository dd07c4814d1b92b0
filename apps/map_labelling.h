// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cloud_doubts.h"
#include "map_arguments.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/labelling/label_predictor.h>

#include <memory>
#include <string>

namespace pcl_semantic::tool {

/** \brief Where the labels of a map's images come from: --network or --labels. */
struct MapLabelling {
  LabelSet label_set;
  std::unique_ptr<LabelPredictor> predictor;
  std::string model;  ///< path; empty without a network
  std::string engine; ///< that computes it
  MappingWatch watch; ///< on the numbers of --labels
};

/** \throws BadInputException, BadModelException, InvalidParameterException */
MapLabelling makeLabelling(const MapArguments& arguments);

} // namespace pcl_semantic::tool
