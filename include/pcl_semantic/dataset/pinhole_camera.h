// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A pinhole camera without distortion: fx, fy, cx, cy [px]. */
struct PinholeCamera {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
  int width = 0;             ///< columns of its images [px]; 0 = not stated, any
  int height = 0;            ///< rows of its images [px]
  std::string calibration{}; ///< its file; empty = none
  std::string stated_size{}; ///< how the file leads to the size, for messages
  std::vector<std::string> doubts{}; ///< about the file: what is not used of it, a line
                                     ///< each, for a program to show

  /** \throws InvalidParameterException unless focal lengths are positive and all is
   * finite */
  void validate() const;

  /** \brief The camera of an image: with its size, and a baseline of 1 m that means
   * nothing.
   * \param[in] image its path, for messages
   * \throws BadInputException that names both sizes, if another one is stated, or if
   * the principal point lies outside of the image */
  StereoCamera ofImage(int image_width, int image_height,
                       const std::string& image) const;
};

/** \brief Reads the camera of undistorted images.
 *
 * | file | what is read |
 * |---|---|
 * | ROS' camera_info (file or message, `.yaml`) | K, D, R, P, size, binning, region of
 * interest |
 * | OpenCV's `camera_matrix` (cv::FileStorage, `.yaml`) | the same |
 * | Kalibr's camchain (`.yaml`) | cam0: intrinsics, resolution, distortion |
 * | EuRoC's sensor.yaml | the same |
 * | KITTI's calib.txt, calib_cam_to_cam.txt | P2 and its size, if stated |
 * | Middlebury's calib.txt | cam0, width, height |
 *
 * Distortion that is not zero is refused: undistort the images first. Without it, a P
 * that differs from K is that of rectified images, and takes its place. Binning divides
 * the size and the matrix, a region of interest shifts the principal point, as ROS'
 * image_geometry does.
 * \throws BadInputException with file and line; models of distortion that are not
 * supported are named */
PinholeCamera readPinholeCamera(const std::string& path);

} // namespace pcl_semantic
