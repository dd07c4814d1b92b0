// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <future>
#include <memory>
#include <optional>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Predicts no labels, for a mapper with late labels. */
class NoLabels : public LabelPredictor {
public:
  LabelDistributions
  predict(const cv::Mat&, int) override
  {
    return {};
  }
};

/** \brief Runs a network in its own thread beside a mapper, on one frame at a time:
 * when idle, it takes the newest mapped frame. Finished labels are fused with the cloud
 * and pose of their frame. Skipped frames provide only depth and colour.
 *
 * The mapper's predictor is NoLabels. The mapper's thread must call all functions. */
class LateLabels {
public:
  /** \param[in] predictor must not be used elsewhere afterwards */
  LateLabels(std::unique_ptr<LabelPredictor> predictor, SemanticMapper& mapper);

  /** \brief Waits for the current frame. */
  ~LateLabels();

  /** \brief After SemanticMapper::process(): starts this frame if the network is
   * idle. */
  void offer(const MappedFrame& mapped);

  /** \brief Before the next frame: fuses finished labels.
   * \return whether labels were finished
   * \throws the exception of the predictor, if labelling a frame has failed */
  bool fuseReady();

  /** \brief At the end: waits for the current frame and fuses its labels.
   * \throws the exception of the predictor, if labelling a frame has failed */
  bool fuseLast();

  /** \brief Number of frames with labels in the map. */
  int
  frames() const
  {
    return frames_;
  }

private:
  std::unique_ptr<LabelPredictor> predictor_;
  SemanticMapper& mapper_;
  std::optional<MappedFrame> frame_; // current frame of the network
  std::future<LabelDistributions> labels_;
  int frames_ = 0;
};

} // namespace pcl_semantic
