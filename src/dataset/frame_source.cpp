// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/frame_source.h>

namespace pcl_semantic {

template <typename Sequence>
void
RecordedFrames::select(std::shared_ptr<const Sequence> sequence,
                       const FrameRange& range)
{
  const std::vector<std::size_t> positions = selectFrames(*sequence, range);
  frames_ = frameTimes(*sequence, positions);
  read_ = [sequence = std::move(sequence), positions](std::size_t i) {
    return sequence->frame(positions[i]);
  };
}

RecordedFrames::RecordedFrames(std::shared_ptr<const FrameSequence> sequence,
                               const FrameRange& range)
{
  sensor_ = {sequence->camera(), sequence->T_camera0_camera()};
  select(std::move(sequence), range);
}

RecordedFrames::RecordedFrames(std::shared_ptr<const RgbdSequence> sequence,
                               const FrameRange& range)
{
  sensor_ = {sequence->camera(), Eigen::Isometry3d::Identity(), true};
  select(std::move(sequence), range);
}

} // namespace pcl_semantic
