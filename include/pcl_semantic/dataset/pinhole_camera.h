// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A pinhole camera and the distortion of its lens: fx, fy, cx, cy [px]. */
struct PinholeCamera {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
  int width = 0;                     ///< columns of its images [px]; 0 = unknown, any
  int height = 0;                    ///< rows of its images [px]
  std::string calibration{};         ///< path of its file; empty = none
  std::string stated_size{};         ///< how the file leads to the size, for messages
  std::vector<std::string> doubts{}; ///< about unused values of the file, one per line,
                                     ///< for a program to print
  std::vector<double> distortion{};  ///< in OpenCV's order; empty = none
  bool is_fisheye = false; ///< distortion is k1 k2 k3 k4 of the equidistant model

  /** \brief Whether the images need Undistorter; those of a fisheye do even with zero
   * coefficients. */
  bool
  isDistorted() const
  {
    return !distortion.empty();
  }

  /** \throws InvalidParameterException unless focal lengths are positive and all values
   * finite */
  void validate() const;

  /** \brief Converts to the camera of an undistorted image, with the image's size and a
   * baseline of 1 m, which is to be ignored. \param[in] image its path, for messages
   * \throws BadInputException that names both sizes, if the file states another size,
   * or if the principal point is outside the image */
  StereoCamera ofImage(int image_width, int image_height,
                       const std::string& image) const;
};

/** \brief Reads a camera and its lens.
 *
 * | file | values |
 * |---|---|
 * | ROS' camera_info (file or message, `.yaml`) | K, D, R, P, size, binning, region of
 * interest |
 * | OpenCV's `camera_matrix` (cv::FileStorage, `.yaml`) | the same |
 * | Kalibr's camchain (`.yaml`) | cam0: intrinsics, resolution, distortion |
 * | EuRoC's sensor.yaml | the same |
 * | KITTI's calib.txt, calib_cam_to_cam.txt | P2 and its size, if stated |
 * | Middlebury's calib.txt | cam0, width, height |
 * | ETH3D's calibration.txt | fx fy cx cy in one line |
 *
 * Distorted images are undistorted (see Undistorter), which a doubt says: coefficients
 * are often stated beside images that are undistorted already. P is then not used.
 * Without distortion, a P that differs from K describes rectified images and replaces
 * K. As in ROS'
 * image_geometry, binning divides the size and the matrix, and a region of interest
 * shifts the principal point.
 * \throws BadInputException with file and line, and with the name of an unsupported
 * distortion model */
PinholeCamera readPinholeCamera(const std::string& path);

/** \brief Does the same for a file, or takes the camera from four numbers.
 * \param[in] calibration path of the file; empty = from \a intrinsics
 * \param[in] intrinsics fx,fy,cx,cy [px]; empty = from the file
 * \throws InvalidParameterException unless one of them is given, or if there are not
 * four numbers */
PinholeCamera pinholeCameraOf(const std::string& calibration,
                              const std::string& intrinsics);

} // namespace pcl_semantic
