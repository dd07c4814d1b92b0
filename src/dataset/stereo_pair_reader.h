// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/sensor_frame.h>

#include <pcl_semantic/dataset/kitti_calibration.h>

#include <string>

namespace pcl_semantic {

/** \brief The PNG files of a pair and what they have to be. */
struct StereoPairFiles {
  std::string left;  ///< path
  std::string right; ///< path
  int frame = 0;     ///< for messages
};

/** \brief Reads one image. \throws BadInputException that names the frame */
cv::Mat readFrameImage(const std::string& path, int frame);

/** \brief Reads both images; they have to be of one type.
 * \param[in] files where they are
 * \param[in] size they must have [px]
 * \param[in] as what says so: "the first image"
 * \return without the time
 * \throws BadInputException that names the frame */
StereoFrame readStereoPair(const StereoPairFiles& files, cv::Size size,
                           const std::string& as);

/** \brief KITTI's calibration with the size of the images filled in.
 * \param[in] size of one of them [px]
 * \throws BadInputException as readKittiCalibration(), or if it cannot be theirs */
KittiCalibration readCalibrationOf(cv::Size size, const std::string& path,
                                   KittiCameras cameras);

} // namespace pcl_semantic
