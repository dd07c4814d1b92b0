// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/rectifier.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The files of a user's stereo camera. */
struct ImagePairFiles {
  std::string left;        ///< pattern of PNG files, see findFiles()
  std::string right;       ///< pattern of the same number of PNG files
  std::string calibration; ///< see readStereoRig(); `.txt`: see readKittiCalibration()
  std::string extrinsics;  ///< R and T, if not in `calibration`
  /// One per row [s]. Empty: of names that are nanoseconds, else ten frames per second.
  std::string times;
};

/** \brief Stereo images of any camera by two patterns, rectified when read unless they
 * are KITTI's, which are rectified already.
 *
 * Pairs are formed by position in natural order. Frame n is the n-th pair from 0, and
 * row n of `times` is its time; names of 17 digits or more are nanoseconds. Camera 0,
 * the reference of trajectories, is the left camera before rectification. */
class ImagePairSequence : public FrameSequence {
public:
  /** \throws BadInputException if a pattern matches nothing, the numbers of left and
   * right images differ, a pair's names have different numbers, the calibration is
   * invalid or for images of another size, or `times` is damaged or too short */
  explicit ImagePairSequence(const ImagePairFiles& files);

  std::size_t
  size() const override
  {
    return left_.size();
  }

  double
  timestamp(std::size_t i) const override
  {
    return times_.empty() ? 0.1 * double(i) : times_.at(i);
  }

  StereoFrame frame(std::size_t i) const override;

  /** \brief The rectified pair. */
  const StereoCamera&
  camera() const override
  {
    return pair_.camera;
  }

  const Eigen::Isometry3d&
  T_camera0_camera() const override
  {
    return pair_.T_camera0_camera;
  }

  /** \brief Doubts about the calibration, one per line. */
  const std::vector<std::string>&
  doubts() const
  {
    return pair_.doubts;
  }

  /** \brief Path of the i-th left image. */
  const std::string&
  leftPath(std::size_t i) const
  {
    return left_.at(i);
  }

private:
  std::vector<std::string> left_, right_; ///< paths
  std::vector<double> times_;             ///< [s]; empty: ten frames per second
  RectifiedPair pair_;
};

/** \brief Whether a path is a video: `.mp4 .avi .mkv .mov`. */
bool isVideo(const std::string& path);

} // namespace pcl_semantic
