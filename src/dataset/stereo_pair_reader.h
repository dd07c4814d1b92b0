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
 * \param[in] size required size (of the first image) [px]; empty = any
 * \throws BadInputException that names the frame */
cv::Mat readFrameImage(const std::string& path, int frame, cv::Size size = {});

/** \brief Reads both images, which must have the same type.
 * \param[in] size required size (of the first image) [px]
 * \return the frame without its time
 * \throws BadInputException that names the frame */
StereoFrame readStereoPair(const StereoPairFiles& files, cv::Size size);

/** \brief Reads KITTI's calibration and adds the size of the images.
 * \param[in] size of an image [px]
 * \param[in] image its path, for messages
 * \throws BadInputException as readKittiCalibration(), or if it does not fit the
 * image */
KittiCalibration readCalibrationOf(cv::Size size, const std::string& image,
                                   const std::string& path, KittiCameras cameras);

/** \brief Reads the times of a file, at least one per frame [s].
 * \param[in] called name of the frames, for messages */
std::vector<double> readTimesOf(const std::string& path, std::size_t frames,
                                const std::string& called);

} // namespace pcl_semantic
