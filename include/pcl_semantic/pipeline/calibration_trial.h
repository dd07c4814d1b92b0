// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/evaluation/confusion_matrix.h>
#include <pcl_semantic/labelling/calibration_fit.h>
#include <pcl_semantic/pipeline/calibration_sequence.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The truth pixels of a sequence: what the network says there, and where they
 * are (frameFeatures).
 * \param[in] config its disparity engine and max_deviation are used
 * \param[in] ground the classes of the ground */
CalibrationSamples calibrationSamples(const CalibrationSequence& sequence,
                                      const MapperConfig& config,
                                      const std::vector<Label>& ground);

/** \brief A calibration of several sequences, and what it is worth on one that it was
 * not fitted to. */
struct CalibrationTrial {
  LabelCalibration all;                  ///< fitted to all sequences
  std::vector<LabelCalibration> without; ///< to all but one; empty if there is but one
  ConfusionMatrix network;               ///< pixels of all sequences, as they come
  ConfusionMatrix fitted;                ///< calibrated by \a all
  ConfusionMatrix held_out;              ///< each sequence by that without it
};

/** \throws BadInputException as fitCalibration() */
CalibrationTrial tryCalibration(const std::vector<CalibrationSamples>& sequences,
                                const std::vector<Label>& ground,
                                const CalibrationOptions& options);

} // namespace pcl_semantic
