// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "renderer.h"

#include <pcl_semantic/core/label_distributions.h>

#include <string>

namespace pcl_semantic {

/** \brief Writes the synthetic street as a sequence of KITTI's odometry benchmark:
 * `image_2 image_3 calib.txt times.txt poses.txt`, with the ground truth beside it:
 * `disparity` (16-bit PNG, 256 x px, 0 = none), `gt` (label ids) and `labels` (`.bin`
 * distributions). */
class SyntheticWriter {
public:
  /** \brief Makes the folders. \throws OutputException */
  explicit SyntheticWriter(std::string folder);

  /** \brief calib.txt, times.txt and poses.txt of a whole scene.
   * \throws OutputException */
  void writeSequence(const SyntheticScene& scene, const StereoCamera& camera) const;

  /** \brief The images, the ground truth and the label distributions of one frame.
   * \throws OutputException */
  void writeFrame(const SyntheticView& view,
                  const LabelDistributions& distributions) const;

private:
  std::string folder_;
};

} // namespace pcl_semantic
