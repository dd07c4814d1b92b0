// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibration_source.h"

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief One camera of a calibration file, for the images: binning and a region of
 * interest are applied already. */
struct CameraFile {
  std::string path;
  int width = 0;    ///< columns of its images [px]; 0 = unknown
  int height = 0;   ///< rows [px]
  std::string size; ///< how the file states them, for messages
  bool is_cropped =
      false; ///< a region of interest: the principal point may be anywhere
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity(); ///< of the original images
  std::vector<double> D;            ///< at least four numbers, in OpenCV's order
  std::string distortion;           ///< source of D, for messages
  bool is_fisheye = false;          ///< D is k1 k2 k3 k4 of the equidistant model
  std::optional<RowMajor34> P;      ///< camera_info: of the rectified images
  std::optional<Eigen::Matrix3d> R; ///< camera_info: takes the camera to the pair
  std::optional<Eigen::Isometry3d> T_body_camera; ///< EuRoC
  Doubts doubts;

  /** \brief Whether the images need a rectification; those of a fisheye do even with
   * zero coefficients. */
  bool isDistorted() const;

  /** \brief Whether a camera_info describes rectified images: without distortion, P
   * differs from K. */
  bool isRectified() const;
};

/** \brief Reads the mapping of a camera in YAML: ROS' camera_info as a file or a
 * message, OpenCV's camera_matrix, a camera of Kalibr's camchain, or EuRoC's
 * sensor.yaml.
 * \throws BadInputException that names the line, or an unsupported model */
CameraFile readYamlCamera(const CalibrationSource& source);

/** \brief Whether a file is Middlebury's calib.txt, of 2014 and later. */
bool isMiddlebury(const std::string& path);

/** \brief Both cameras of Middlebury's calib.txt and their baseline [m], converted from
 * millimetres. */
struct MiddleburyFile {
  CameraFile left, right;
  double baseline = 0.0;
};

MiddleburyFile readMiddlebury(const std::string& path);

/** \brief Columns and rows in a file; zeros if missing.
 * \throws BadInputException if one is less than two, or two sizes differ */
std::pair<int, int> readCameraSize(const CalibrationSource& source);

/** \brief Whether a YAML file states the equidistant model of fisheye lenses (Kannala
 * and Brandt): `distortion_model: equidistant` or `fisheye`, or `fisheye_model: 1`.
 * \throws BadInputException that names the line of an unsupported model */
bool readsFisheye(const CalibrationSource& source,
                  const CalibrationSource::Keys& pinhole_models);

/** \brief Whether a YAML file has one camera for readYamlCamera(). */
bool isYamlCamera(const CalibrationSource& source);

/** \brief Reads a single camera.
 *
 * From Kalibr's camchain and Middlebury's calib.txt it reads cam0, from KITTI's file
 * camera 2. The doubts list unused cameras.
 * \throws BadInputException */
CameraFile readCameraFile(const std::string& path);

/** \brief Converts a number to columns or rows of an image. \throws
 * BadInputException */
int wholePixels(double number, const std::string& where);

/** \brief Requires a camera matrix fx 0 cx, 0 fy cy, 0 0 1. \throws
 * BadInputException */
void requireCameraMatrix(const Eigen::Matrix3d& K, const std::string& where);

/** \throws BadInputException that names both sizes, if the file states a size other
 * than the image's
 * \param[in] image its path */
void requireStatedSize(int width, int height, const std::string& stated,
                       const std::string& calibration, int image_width,
                       int image_height, const std::string& image);

} // namespace pcl_semantic
