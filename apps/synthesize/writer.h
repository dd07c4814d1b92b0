// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "renderer.h"

#include <pcl_semantic/core/label_distributions.h>

#include <string>

namespace pcl_semantic {

/** \brief Writes the synthetic street as a sequence of KITTI's odometry benchmark:
 * `image_2 image_3 calib.txt times.txt poses.txt`, and the ground truth: `disparity`
 * (16-bit PNG, 256 x px, 0 = none), `gt` (label ids) and `labels` (`.bin`
 * distributions). Of a fisheye pair only the images, Kalibr's `camchain.yaml`,
 * `times.txt` and `poses.txt`: truth is that of rectified images. */
class SyntheticWriter {
public:
  /** \brief Creates the folders. \throws OutputException */
  explicit SyntheticWriter(std::string folder,
                           synthetic::Lens lens = synthetic::Lens::pinhole);

  /** \brief Writes the calibration, times.txt and poses.txt of a whole scene.
   * \throws OutputException */
  void writeSequence(const SyntheticScene& scene, const StereoCamera& camera) const;

  /** \brief Writes the images of a frame. \throws OutputException */
  void writeImages(const SyntheticView& view) const;

  /** \brief Writes the images, the ground truth and the label distributions of a frame.
   * \throws OutputException */
  void writeFrame(const SyntheticView& view,
                  const LabelDistributions& distributions) const;

private:
  std::string folder_;
  synthetic::Lens lens_;
};

} // namespace pcl_semantic
