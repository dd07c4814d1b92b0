// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/late_labels.h>

#include <pcl_semantic/core/threads.h>

#include <chrono>
#include <utility>

#include <omp.h>

namespace pcl_semantic {

LateLabels::LateLabels(std::unique_ptr<LabelPredictor> predictor,
                       SemanticMapper& mapper)
    : predictor_(std::move(predictor)), mapper_(mapper)
{}

LateLabels::~LateLabels() = default; // the future of std::async waits

void
LateLabels::offer(const MappedFrame& mapped)
{
  if (frame_)
    return;
  frame_.emplace(); // only the members that addLabels() needs
  frame_->cloud = mapped.cloud;
  frame_->T_world_camera = mapped.T_world_camera;
  labels_ = std::async(std::launch::async,
                       [this, image = mapped.image, frame = mapped.frame.number,
                        threads = omp_get_max_threads()] {
                         const ThreadScope scope(threads); // new threads default to all
                         return predictor_->predict(image, frame);
                       });
}

bool
LateLabels::fuseReady()
{
  return frame_ &&
         labels_.wait_for(std::chrono::seconds(0)) == std::future_status::ready &&
         fuseLast();
}

bool
LateLabels::fuseLast()
{
  if (!frame_)
    return false;
  const MappedFrame frame = *std::exchange(frame_, std::nullopt);
  LabelDistributions labels = labels_.get();
  if (labels.empty())
    return false;
  mapper_.addLabels(frame, std::move(labels));
  ++frames_;
  return true;
}

} // namespace pcl_semantic
