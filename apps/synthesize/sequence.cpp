// SPDX-License-Identifier: BSD-3-Clause
#include "sequence.h"

#include "labels.h"

namespace pcl_semantic {

SyntheticSequence::SyntheticSequence(int frames, int width, int height,
                                     const Eigen::Isometry3d& T_rig_camera,
                                     std::uint32_t seed)
    : scene_(seed, frames), renderer_(scene_, width, height),
      T_camera0_camera_(
          Eigen::Translation3d(SyntheticRenderer::camera_2_offset, 0.0, 0.0) *
          T_rig_camera)
{}

Eigen::Isometry3d
SyntheticSequence::pose(std::size_t i) const
{
  return scene_.pose(frameNumber(i)) * T_camera0_camera_;
}

SyntheticView
SyntheticSequence::view(std::size_t i) const
{
  return renderer_.render(frameNumber(i), pose(i));
}

StereoFrame
SyntheticSequence::frame(std::size_t i) const
{
  const SyntheticView seen = view(i);
  return {{frameNumber(i), timestamp(i)}, seen.left, seen.right};
}

LabelDistributions
SyntheticSequence::labels(std::size_t i) const
{
  return syntheticDistributions(view(i), scene_.seed());
}

} // namespace pcl_semantic
