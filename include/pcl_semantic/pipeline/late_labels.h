// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/labelling/label_predictor.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <future>
#include <memory>
#include <optional>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Predicts no labels, for a mapper whose labels come later. */
class NoLabels : public LabelPredictor {
public:
  LabelDistributions
  predict(const cv::Mat&, int) override
  {
    return {};
  }
};

/** \brief A network that works beside a mapper, in a thread of its own, on one frame
 * at a time: whenever it is free, on the one that was mapped last. When its labels are
 * ready they are fused with the cloud and pose of the frame they belong to. Frames that
 * it had no time for bring depth and colour alone.
 *
 * The mapper has NoLabels for its predictor. All functions are called by its thread. */
class LateLabels {
public:
  /** \param[in] predictor nothing else may use it from now on */
  LateLabels(std::unique_ptr<LabelPredictor> predictor, SemanticMapper& mapper);

  /** \brief Waits for the frame that is being labelled. */
  ~LateLabels();

  /** \brief After SemanticMapper::process(): begins with this frame if the network is
   * free. */
  void offer(const MappedFrame& mapped);

  /** \brief Before the next one: fuses the labels that are ready.
   * \return whether there were any
   * \throws what the predictor threw */
  bool fuseReady();

  /** \brief At the end: waits for the frame that is being labelled and fuses its
   * labels. \throws what the predictor threw */
  bool fuseLast();

  /** \brief Frames whose labels are in the map. */
  int
  frames() const
  {
    return frames_;
  }

private:
  std::unique_ptr<LabelPredictor> predictor_;
  SemanticMapper& mapper_;
  std::optional<MappedFrame> frame_; // the network works on it
  std::future<LabelDistributions> labels_;
  int frames_ = 0;
};

} // namespace pcl_semantic
