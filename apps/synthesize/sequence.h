// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "renderer.h"

#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/dataset/frame_sequence.h>

namespace pcl_semantic {

/** \brief The synthetic street as a sequence in memory, with poses and labels. Frames
 * are rendered on demand. The first frame is at the world's origin. */
class SyntheticSequence : public FrameSequence {
public:
  /** \param[in] frames number of frames
   * \param[in] width of the images [px]
   * \param[in] height of the images [px]
   * \param[in] T_rig_camera left camera relative to that of a car looking along the
   * road
   * \param[in] seed of the street and of the mistakes in its labels
   * \throws InvalidParameterException as SyntheticScene and SyntheticRenderer */
  SyntheticSequence(
      int frames, int width, int height,
      const Eigen::Isometry3d& T_rig_camera = Eigen::Isometry3d::Identity(),
      std::uint32_t seed = 1);

  std::size_t
  size() const override
  {
    return std::size_t(scene_.frames());
  }

  double
  timestamp(std::size_t i) const override
  {
    return double(i) * SyntheticScene::seconds_per_frame;
  }

  StereoFrame frame(std::size_t i) const override;

  const StereoCamera&
  camera() const override
  {
    return renderer_.camera();
  }

  const Eigen::Isometry3d&
  T_camera0_camera() const override
  {
    return T_camera0_camera_;
  }

  /** \brief T_world_camera of the i-th frame: its left camera [m]. */
  Eigen::Isometry3d pose(std::size_t i) const;

  /** \brief The i-th frame with its ground truth. */
  SyntheticView view(std::size_t i) const;

  /** \brief Simulated network labels of the i-th left image: L x (width * height), see
   * syntheticDistributions(). */
  LabelDistributions labels(std::size_t i) const;

private:
  SyntheticScene scene_;
  SyntheticRenderer renderer_;
  Eigen::Isometry3d T_camera0_camera_;
};

} // namespace pcl_semantic
