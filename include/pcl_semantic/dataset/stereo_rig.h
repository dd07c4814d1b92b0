// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Two calibrated cameras side by side, as described by OpenCV's
 * `stereoCalibrate`: pinhole cameras with OpenCV's polynomial distortion, or fisheye
 * lenses with the equidistant model (Kannala and Brandt, 2006), as `cv::fisheye`.
 *
 * A point x_1 in the left camera's frame is x_2 = R x_1 + T in the right camera's
 * frame. */
struct StereoRig {
  int width = 0;          ///< columns of both images [px]; 0 = unknown
  int height = 0;         ///< rows of both images [px]; 0 = unknown
  Eigen::Matrix3d K1, K2; ///< fx 0 cx, 0 fy cy, 0 0 1 [px]; left, right
  /// k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 .. s4 [tx ty]]]], of fisheyes k1 k2 k3 k4
  std::vector<double> D1, D2;
  bool is_fisheye = false;   ///< both lenses
  Eigen::Matrix3d R;         ///< rotation from the left to the right camera's frame
  Eigen::Vector3d T;         ///< translation from the left to the right frame; x < 0
  std::string stated_size{}; ///< derivation of the size from the file, for messages
  std::vector<std::string>
      doubts; ///< about the file, one per line, for a program to print

  /** \throws InvalidParameterException that names the value, unless everything is
   * finite, K1 and K2 are camera matrices with the principal point in the image, D1 and
   * D2 have 4, 5, 8, 12 or 14 numbers (of fisheyes 4), R is a rotation, and T places
   * the right camera to the right (not above or ahead) within 10 m */
  void validate() const;
};

/** \brief Reads a rig in YAML of `cv::FileStorage`, Kalibr's camchain (cam0 is the left
 * camera, cam1 the right one; pinhole with radtan or equidistant), ROS' camera_info of
 * both cameras (plumb_bob, rational_polynomial, equidistant or fisheye), EuRoC's
 * sensor.yaml of both, or Middlebury's calib.txt. Both cameras must have the same size,
 * or none.
 *
 * A camera_info without distortion and rotation describes rectified images, with P as
 * the camera's matrix. Binning and a region of interest are applied, see
 * readPinholeCamera(). Keys of OpenCV's YAML:
 *
 * | value | key, one of |
 * |---|---|
 * | K1, K2 | `K1`, `M1`, `cameraMatrix1`, `camera_matrix_1`; 2 accordingly |
 * | D1, D2 | `D1`, `distCoeffs1`, `dist_coeffs_1`; 2 accordingly |
 * | R, T | `R`, `T` |
 * | fisheye lenses | `distortion_model: equidistant` or `fisheye_model: 1` |
 * | size | `image_width` and `image_height`, or `image_size`, `imageSize`; may be
 * absent |
 *
 * A matrix is an `!!opencv-matrix` or a list of numbers, row by row. Other keys are
 * ignored. R is replaced by the nearest rotation. A difference above 1e-4, more than
 * the rounding of text, is a doubt; above 1e-2 R is refused.
 * \param[in] path the calibration, or only the intrinsics
 * \param[in] extrinsics_path file of R and T, if separate; for ROS and EuRoC the right
 * camera's file
 * \throws BadInputException that names the file and the key, if a value is missing or
 * invalid, or the sizes of the cameras differ */
StereoRig readStereoRig(const std::string& path,
                        const std::string& extrinsics_path = "");

} // namespace pcl_semantic
