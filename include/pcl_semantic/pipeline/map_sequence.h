// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Maps a whole sequence in one call. The poses are from the sequence's
 * trajectory or, without one, from StereoOdometry.
 * \param[in] label_set the classes of \a predictor
 * \param[out] doubts if not null: doubts about the trajectory are appended, see
 * readTrajectory()
 * \return all occupied voxels, refined according to \a config
 * \throws InvalidParameterException, BadInputException or BadModelException as
 * SemanticMapper; before the first frame, if the trajectory lacks a frame's pose */
VoxelCloud mapSequence(const FrameSequence& sequence, const LabelSet& label_set,
                       std::unique_ptr<LabelPredictor> predictor,
                       const MapperConfig& config = MapperConfig(),
                       std::vector<std::string>* doubts = nullptr);

} // namespace pcl_semantic
