// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/pinhole_camera.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Removes the distortion of a lens from the images of one camera.
 *
 * The undistorted images have the same size and axes. Their camera matrix is chosen so
 * that no pixel comes from outside the image: `cv::getOptimalNewCameraMatrix()` with
 * alpha = 0 or, for a fisheye,
 * `cv::fisheye::estimateNewCameraMatrixForUndistortRectify()` with balance = 0. Images
 * of a camera without distortion stay as they are. */
class Undistorter {
public:
  /** \param[in] width, height of the camera's images [px]
   * \param[in] image path of one, for messages
   * \throws BadInputException as PinholeCamera::ofImage(), or if the distortion folds
   * the images */
  Undistorter(const PinholeCamera& camera, int width, int height,
              const std::string& image);

  /** \brief The camera of the undistorted images, with a baseline of 1 m, which is to
   * be ignored. */
  const StereoCamera&
  camera() const
  {
    return camera_;
  }

  /** \brief Whether images change. */
  bool
  isDistorted() const
  {
    return !whole_.empty();
  }

  /** \brief Undistorts an image bilinearly.
   * \throws InvalidParameterException if the image has another size */
  cv::Mat undistort(const cv::Mat& image) const;

  /** \brief Does the same for depths or labels: a pixel has the value of the nearest
   * source, because a mean of two surfaces is on neither. */
  cv::Mat undistortNearest(const cv::Mat& image) const;

private:
  void requireSize(const cv::Mat& image) const;

  StereoCamera camera_;
  cv::Mat whole_, fraction_, nearest_; ///< sources, see cv::convertMaps()
};

} // namespace pcl_semantic
