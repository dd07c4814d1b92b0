// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "calibration_source.h"

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief One camera as a calibration file states it. All is that of the images: what
 * the file says of binning and of a region of interest is applied already. */
struct CameraFile {
  std::string path;
  int width = 0;    ///< columns of its images [px]; 0 = not stated
  int height = 0;   ///< rows [px]
  std::string size; ///< how the file states them, for messages
  bool is_cropped =
      false; ///< a region of interest: the principal point may be anywhere
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity(); ///< of the images as they were taken
  std::vector<double> D;            ///< at least four numbers, as OpenCV orders them
  std::string distortion;           ///< where D stands, for messages
  std::optional<RowMajor34> P;      ///< camera_info: of the rectified images
  std::optional<Eigen::Matrix3d> R; ///< camera_info: takes the camera to the pair
  std::optional<Eigen::Isometry3d> T_body_camera; ///< EuRoC
  Doubts doubts;

  bool isDistorted() const;

  /** \brief Whether a camera_info is that of rectified images: without distortion, P
   * differs from K. */
  bool isRectified() const;
};

/** \brief Reads the mapping of a camera in YAML: ROS' camera_info as a file or a
 * message, OpenCV's camera_matrix, a camera of Kalibr's camchain, or EuRoC's
 * sensor.yaml. \throws BadInputException that names the line, and a model that is not
 * supported */
CameraFile readYamlCamera(const CalibrationSource& source);

/** \brief Whether a file is Middlebury's calib.txt, of 2014 and later. */
bool isMiddlebury(const std::string& path);

/** \brief Both cameras of Middlebury's calib.txt and their baseline [m], which is in
 * millimetres there. */
struct MiddleburyFile {
  CameraFile left, right;
  double baseline = 0.0;
};

MiddleburyFile readMiddlebury(const std::string& path);

/** \brief Columns and rows that a file states; zeros if it states none.
 * \throws BadInputException if there are less than two, or two sizes that differ */
std::pair<int, int> readCameraSize(const CalibrationSource& source);

/** \brief Whether the YAML of a file holds one camera that readYamlCamera() reads. */
bool isYamlCamera(const CalibrationSource& source);

/** \brief Reads the one camera that a file is given for.
 *
 * Of Kalibr's camchain cam0, of Middlebury's calib.txt cam0, of KITTI's camera 2.
 * Cameras that are not used are among the doubts. \throws BadInputException */
CameraFile readCameraFile(const std::string& path);

/** \brief Columns or rows of an image from text. \throws BadInputException */
int wholePixels(double number, const std::string& where);

/** \brief A camera matrix fx 0 cx, 0 fy cy, 0 0 1. \throws BadInputException */
void requireCameraMatrix(const Eigen::Matrix3d& K, const std::string& where);

/** \throws BadInputException that names both sizes, if the file states one and it is
 * not that of an image \param[in] image its path */
void requireStatedSize(int width, int height, const std::string& stated,
                       const std::string& calibration, int image_width,
                       int image_height, const std::string& image);

} // namespace pcl_semantic
