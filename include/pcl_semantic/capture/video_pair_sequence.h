// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Stereo pairs of two synchronous videos. Frame n, from 0, consists of the n-th
 * image of both, rectified. Its time is row n of `times` [s]. Without `times` it is n
 * divided by the left video's frame rate.
 *
 * Frames are read fastest in ascending order: an earlier frame is decoded from the
 * start of the videos. Several threads must not use one instance at once. */
class VideoPairSequence : public FrameSequence {
public:
  /** \param[in] files `left` and `right` are videos
   * \throws BadInputException if a video cannot be read, or the videos differ in size,
   * length or rate (by more than 0.01 per second)
   * \throws BadInputException if the calibration is invalid or for another image size,
   * or `times` has not one row per frame */
  explicit VideoPairSequence(const ImagePairFiles& files);

  ~VideoPairSequence() override;

  std::size_t size() const override;

  double timestamp(std::size_t i) const override;

  /** \brief Reads a frame.
   * \throws BadInputException that names the video and the frame, if it cannot be
   * decoded */
  StereoFrame frame(std::size_t i) const override;

  const StereoCamera& camera() const override;

  const Eigen::Isometry3d& T_camera0_camera() const override;

  /** \brief Doubts about the calibration, one per line. */
  const std::vector<std::string>& doubts() const;

private:
  struct Videos;
  std::unique_ptr<Videos> videos_;
};

} // namespace pcl_semantic
