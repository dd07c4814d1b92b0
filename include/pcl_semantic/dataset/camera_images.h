// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/pinhole_camera.h>
#include <pcl_semantic/dataset/undistorter.h>

#include <opencv2/core/mat.hpp>

#include <map>
#include <optional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Images of one camera, by frame number.
 *
 * If every name that matches a pattern is an integer up to 999999, it is the frame
 * number. Otherwise frame n is the n-th image from 0 in natural order. CloudSequence
 * counts in the same way. */
class CameraImages {
public:
  /** \param[in] pattern see findFiles()
   * \param[in] camera of the images, which are undistorted
   * \throws BadInputException if it matches nothing, or two names have one number */
  CameraImages(const std::string& pattern, const PinholeCamera& camera);

  /** \param[in] paths of undistorted images by frame
   * \param[in] camera with its image size
   * \param[in] name of the sequence, for messages */
  CameraImages(std::map<int, std::string> paths, const StereoCamera& camera,
               std::string name);

  /** \brief The camera of the undistorted images with its image size. For a pattern, it
   * has the size of the first image, and its baseline of 1 m is ignored. */
  const StereoCamera&
  camera() const
  {
    return camera_;
  }

  bool
  has(int frame) const
  {
    return paths_.count(frame) > 0;
  }

  /** \brief Reads the image of a frame without distortion, CV_8UC3 (BGR) or CV_8UC1.
   * \throws BadInputException if it does not exist or does not have the camera's
   * size */
  cv::Mat image(int frame) const;

private:
  std::map<int, std::string> paths_; ///< by frame
  StereoCamera camera_;
  std::optional<Undistorter> undistorter_; ///< of a camera with a lens
  std::string name_;
};

} // namespace pcl_semantic
