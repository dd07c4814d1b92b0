// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Maps a whole sequence in one call. Its poses are those of its own trajectory
 * or, without one, found in the images (StereoOdometry).
 * \param[in] label_set the classes that \a predictor gives
 * \param[out] doubts if not null: those of the trajectory, see readTrajectory(), are
 * added to it
 * \return all occupied voxels, refined as \a config says
 * \throws InvalidParameterException, BadInputException or BadModelException as
 * SemanticMapper; before the first frame, if one has no pose in the trajectory */
VoxelCloud mapSequence(const FrameSequence& sequence, const LabelSet& label_set,
                       std::unique_ptr<LabelPredictor> predictor,
                       const MapperConfig& config = MapperConfig(),
                       std::vector<std::string>* doubts = nullptr);

} // namespace pcl_semantic
