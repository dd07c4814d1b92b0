// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/dataset/stereo_rig.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <Eigen/Geometry>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Which image of a stereo pair. */
enum class StereoSide { left = 0, right = 1 };

/** \brief Turns the images of a rig into those of a rectified pair of the same size:
 * without distortion, corresponding pixels in the same row.
 *
 * Both cameras are turned as little as possible (Bouguet's method, `cv::stereoRectify`
 * with CALIB_ZERO_DISPARITY) and get the same focal length and principal point, chosen
 * so that (but for single pixels of the margin) none comes from outside an image, alpha
 * = 0: what only one of the two cameras or a corner sees is cut off. */
class Rectifier {
public:
  /** \param[in] rig cameras with the size of their images
   * \throws InvalidParameterException if a value of the rig cannot be used, its size is
   * not known, or the distortion folds the images */
  explicit Rectifier(const StereoRig& rig);

  /** \brief The rectified pair; the left camera's frame is that of its images. */
  const StereoCamera&
  camera() const
  {
    return camera_;
  }

  /** \brief Pose of the rectified left camera in the rig's left camera: a rotation
   * about its centre, the transposed R1 of `cv::stereoRectify`. */
  const Eigen::Isometry3d&
  T_left_rectified() const
  {
    return T_left_rectified_;
  }

  /** \brief A rectified image, bilinear, black where the camera saw nothing. What is
   * rectified already comes back unchanged.
   * \param[in] image of the rig's size, any depth and number of channels
   * \param[in] side which camera took it
   * \throws InvalidParameterException if the image is of another size */
  cv::Mat rectify(const cv::Mat& image, StereoSide side) const;

private:
  // Where a pixel comes from: whole pixels and 1/32 px (cv::convertMaps).
  struct Maps {
    cv::Mat whole;
    cv::Mat fraction;
  };

  StereoCamera camera_;
  Eigen::Isometry3d T_left_rectified_ = Eigen::Isometry3d::Identity();
  std::array<Maps, 2> maps_; ///< empty if there is nothing to do
};

/** \brief A calibrated stereo pair, as its rectified images are. */
struct RectifiedPair {
  StereoCamera camera;                                                ///< with its size
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity(); ///< left camera
  std::optional<Rectifier> rectifier; ///< none if the images are rectified already
  std::vector<std::string> doubts{};  ///< about the files, a line each

  /** \brief Rectifies the images of a frame, if they are not yet. */
  void rectify(StereoFrame& frame) const;
};

/** \brief Files that describe a pair. */
struct CalibrationFiles {
  std::string calibration; ///< `.txt`: see readKittiCalibration(); readStereoRig()
  std::string extrinsics;  ///< R and T of a rig, if not in `calibration`
};

/** \brief The images that the calibration is used with: their size, and their name for
 * messages. */
struct SizedFile {
  cv::Size size; ///< [px]
  std::string path;
};

/** \brief Reads the calibration of images, or of organized clouds made of them. Camera
 * 0 is KITTI's, or the left camera of a rig before rectification turns it.
 * \param[in] cameras which of KITTI's pairs; a rig has one
 * \throws BadInputException if it cannot be used, or is of images of another size */
RectifiedPair readRectifiedPair(const CalibrationFiles& files, const SizedFile& first,
                                KittiCameras cameras);

} // namespace pcl_semantic
