// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "room_renderer.h"

#include <pcl_semantic/core/label_distributions.h>

#include <string>

namespace pcl_semantic {

/** \brief Writes the synthetic room as an RGB-D sequence: `rgb depth` (16-bit PNG, mm),
 * `camera.yaml poses.txt` (T_world_camera, z up), and the ground truth: `gt` (label
 * ids) and `labels` (`.bin` distributions). Of a fisheye no ground truth: it is that of
 * undistorted images. */
class RoomWriter {
public:
  /** \brief Creates the folders. \throws OutputException */
  explicit RoomWriter(std::string folder,
                      synthetic::Lens lens = synthetic::Lens::pinhole);

  /** \brief Writes camera.yaml and poses.txt. \throws OutputException */
  void writeSequence(const SyntheticRoom& room, const StereoCamera& camera) const;

  /** \brief Writes the images of a frame.
   * \param[in] depth CV_16UC1 [mm]
   * \throws OutputException */
  void writeImages(const RoomView& view, const cv::Mat& depth) const;

  /** \brief Writes the images, the ground truth and the label distributions of a frame.
   * \param[in] depth CV_16UC1 [mm]
   * \throws OutputException */
  void writeFrame(const RoomView& view, const cv::Mat& depth,
                  const LabelDistributions& distributions) const;

private:
  std::string folder_;
  synthetic::Lens lens_;
};

} // namespace pcl_semantic
