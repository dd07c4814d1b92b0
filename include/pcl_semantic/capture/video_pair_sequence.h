// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/image_pair_sequence.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Stereo pairs of two synchronous videos, rectified when read. Frame n is the
 * n-th image of both. Its time is n divided by the left video's frame rate, or row n of
 * `times`. Frames are read in order; going back restarts the videos. One instance must
 * not be used by several threads at once. */
class VideoPairSequence : public FrameSequence {
public:
  /** \param[in] files `left` and `right` are videos
   * \throws BadInputException if one cannot be read, they differ in size, rate or
   * length, or the calibration does not fit */
  explicit VideoPairSequence(const ImagePairFiles& files);

  ~VideoPairSequence() override;

  std::size_t size() const override;

  double timestamp(std::size_t i) const override;

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
