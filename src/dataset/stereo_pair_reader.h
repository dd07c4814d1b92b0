// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The images of a pair. */
struct StereoPairFiles {
  std::string left;  ///< path
  std::string right; ///< path
  int frame = 0;     ///< for messages
};

/** \brief Reads one image.
 * \param[in] size of the first image, which it must have [px]; empty: it is the first
 * \throws BadInputException that names the frame */
cv::Mat readFrameImage(const std::string& path, int frame, cv::Size size = {});

/** \brief Reads both images; they have to be of one type.
 * \param[in] size of the first image, which they must have [px]
 * \return without the time
 * \throws BadInputException that names the frame */
StereoFrame readStereoPair(const StereoPairFiles& files, cv::Size size);

/** \brief KITTI's calibration with the size of the images filled in.
 * \param[in] size of one of them [px]
 * \param[in] image its path, for messages
 * \throws BadInputException as readKittiCalibration(), or if it cannot be theirs */
KittiCalibration readCalibrationOf(cv::Size size, const std::string& image,
                                   const std::string& path, KittiCameras cameras);

/** \brief The times of a file, at least one a frame [s].
 * \param[in] called what the frames are, for messages */
std::vector<double> readTimesOf(const std::string& path, std::size_t frames,
                                const std::string& called);

} // namespace pcl_semantic
