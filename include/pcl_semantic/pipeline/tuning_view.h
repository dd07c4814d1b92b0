// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>
#include <pcl_semantic/pipeline/tuning_score.h>

#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A mapped frame and which of its voxels the pixels of its truth see. The
 * labels of the voxels may change: counting is then all that is left to do. */
struct TuningView {
  MappedFrame mapped; ///< without what only the map needs

  // Of the pixels with truth:
  std::vector<Label> truth;
  std::vector<Label> network;         ///< MAP labels of the 2D network
  std::vector<std::int32_t> at_depth; ///< place of the voxel in the cloud; -1 = none
  std::vector<std::int32_t> rendered; ///< likewise

  /** \brief Memory of the larger arrays [bytes]. */
  std::size_t memory() const;
};

/** \brief Looks at the truth of a frame through the map as it stands.
 * \param[in] mapped after the map has taken it in
 * \param[in] truth CV_8UC1 of the frame's size; empty = none, then nothing is counted
 * \param[in] max_depth surfaces further away are not seen [m] */
TuningView makeTuningView(MappedFrame mapped, const SemanticVoxelMap& map,
                          const StereoCamera& camera, const cv::Mat& truth,
                          double max_depth);

/** \brief Adds the counts of a frame: labels as the voxel cloud has them. */
void countView(const TuningView& view, TuningResult& result);

} // namespace pcl_semantic
