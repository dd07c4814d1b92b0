// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sequence_options.h"

#include <string>

namespace pcl_semantic::tool {

/** \brief The command line of pcl_semantic_label. */
struct LabelArguments {
  SequenceOptions sequence;
  std::string clouds; ///< instead of the sequence: organized clouds to label
  std::string output, network, model, labels, label_set;
  std::string frames = ":";
  std::string format = "float32";
  double label_confidence = 0.8; ///< of a stored `.png`
  int threads = 0;
};

extern const Usage label_usage;

/** \brief Reads it.
 * \return false if nothing is left to do, see parseCommandLine()
 * \throws InvalidParameterException */
bool parseLabelArguments(int argc, char** argv, LabelArguments& arguments);

/** \brief Labels clouds: writes a labelled cloud for each. \return exit code
 * \throws BadInputException, BadModelException, OutputException */
int labelClouds(const LabelArguments& arguments);

} // namespace pcl_semantic::tool
