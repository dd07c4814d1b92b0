// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/dataset/rectifier.h>

#include <Eigen/Geometry>
#include <opencv2/core/types.hpp>

#include <optional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A calibrated stereo pair, as its rectified images are. */
struct RectifiedPair {
  StereoCamera camera;                                                ///< with its size
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity(); ///< left camera
  std::optional<Rectifier> rectifier; ///< none if the images are rectified already
};

/** \brief Files that describe a pair. */
struct CalibrationFiles {
  std::string calibration; ///< `.txt`: see readKittiCalibration(); readStereoRig()
  std::string extrinsics;  ///< R and T of a rig, if not in `calibration`
};

/** \brief What the calibration is used with, for its size and for messages. */
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
