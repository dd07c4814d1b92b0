// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/labelling/calibration_fit.h>
#include <pcl_semantic/pipeline/calibration_sequence.h>
#include <pcl_semantic/pipeline/mapper_config.h>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The cliques of a sequence's map as tryCalibration() takes them: the truth
 * pixels of a frame are looked up at their own depth and as the map is seen from there
 * (to max_depth); those that meet a voxel in a clique are its truth. A sample describes
 * a clique, and weighs the number of its pixels that are of one class.
 * \param[in] config the map and its cliques; no CRF is run
 * \param[in] ground the classes of the ground */
CalibrationSamples cliqueSamples(const CalibrationSequence& sequence,
                                 const MapperConfig& config, const LabelSet& label_set,
                                 const std::vector<Label>& ground);

} // namespace pcl_semantic
