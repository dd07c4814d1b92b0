// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/pinhole_camera.h>

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Images of one camera without distortion, by a pattern.
 *
 * If every name is a whole number up to 999999 it is the frame's number; else frame n
 * is the n-th image from 0 in natural order. CloudSequence counts likewise. */
class CameraImages {
public:
  /** \param[in] pattern see findFiles()
   * \throws BadInputException if it matches nothing, or two names have one number */
  CameraImages(const std::string& pattern, const PinholeCamera& camera);

  /** \brief The camera, with the size of the first image; a baseline of 1 m that means
   * nothing. */
  const StereoCamera&
  camera() const
  {
    return camera_;
  }

  /** \brief The numbers of the frames, in natural order of their files. */
  const std::vector<int>&
  numbers() const
  {
    return numbers_;
  }

  /** \brief The image of a frame, CV_8UC3 (BGR) or CV_8UC1.
   * \throws BadInputException if there is none, or it has another size than the first
   */
  cv::Mat image(int frame) const;

private:
  std::string pattern_;
  std::vector<std::string> paths_;
  std::vector<int> numbers_;
  StereoCamera camera_;
};

} // namespace pcl_semantic
