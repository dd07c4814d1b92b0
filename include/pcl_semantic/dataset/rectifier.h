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

/** \brief Image of a stereo pair. */
enum class StereoSide { left = 0, right = 1 };

/** \brief Rectifies the images of a rig to a pair of the same size: without distortion,
 * with corresponding pixels in the same row.
 *
 * Both cameras are rotated as little as possible (Bouguet's method, `cv::stereoRectify`
 * or, for fisheyes, `cv::fisheye::stereoRectify`, with CALIB_ZERO_DISPARITY). They get
 * the same focal length and principal point, chosen with alpha = 0: except for single
 * border pixels, no pixel comes from outside an image, and regions seen by only one
 * camera or in a corner are cropped. */
class Rectifier {
public:
  /** \param[in] rig cameras with the size of their images
   * \throws InvalidParameterException if a value of the rig is invalid, its size is
   * unknown, or the distortion folds the images */
  explicit Rectifier(const StereoRig& rig);

  /** \brief The rectified pair, in the frame of the rectified left camera. */
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

  /** \brief Rectifies an image bilinearly; pixels from outside are black. A rectified
   * image is returned unchanged.
   * \param[in] image of the rig's size, any depth and number of channels
   * \param[in] side of the camera
   * \throws InvalidParameterException if the image has another size */
  cv::Mat rectify(const cv::Mat& image, StereoSide side) const;

private:
  // Source of a pixel: whole pixels and 1/32 px (cv::convertMaps).
  struct Maps {
    cv::Mat whole;
    cv::Mat fraction;
  };

  StereoCamera camera_;
  Eigen::Isometry3d T_left_rectified_ = Eigen::Isometry3d::Identity();
  std::array<Maps, 2> maps_; ///< empty if the rig is rectified
};

/** \brief The calibration of a pair's rectified images. */
struct RectifiedPair {
  StereoCamera camera;                                                ///< with its size
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity(); ///< left camera
  std::optional<Rectifier> rectifier; ///< none if the images are rectified already
  std::vector<std::string> doubts{};  ///< about the files, one per line

  /** \brief Rectifies the images of a frame, if they are not yet. */
  void rectify(StereoFrame& frame) const;
};

/** \brief Files that describe a pair. */
struct CalibrationFiles {
  std::string calibration; ///< `.txt`: see readKittiCalibration(); readStereoRig()
  std::string extrinsics;  ///< R and T of a rig, if not in `calibration`
};

/** \brief Size and name (for messages) of the images used with a calibration. */
struct SizedFile {
  cv::Size size; ///< [px]
  std::string path;
};

/** \brief Reads the calibration of images, or of organized clouds made from them.
 * Camera 0 is KITTI's, or the left camera of a rig before rectification.
 * \param[in] cameras KITTI's pair; ignored for a rig
 * \throws BadInputException if the calibration is invalid or for images of another
 * size */
RectifiedPair readRectifiedPair(const CalibrationFiles& files, const SizedFile& first,
                                KittiCameras cameras);

} // namespace pcl_semantic
