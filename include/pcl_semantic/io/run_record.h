// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/scan.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

// Information in an archive about the run that made it: a description in "name: value"
// lines, and one record per frame.

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Sensor of a run: relates the poses of another trajectory to it. */
struct RunSensor {
  /// Pose of the frames' camera or scanner in camera 0, if the trajectory contains the
  /// poses of camera 0.
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  bool has_own_poses = false; ///< poses are those of the sensor, in a world with z up
};

/** \brief Parses the sensor from a run's description.
 * \throws BadInputException if it is missing */
RunSensor sensorOf(const std::string& description);

/** \brief Checksums that tell whether a frame is the one a map was made from. They
 * detect accidental changes, not forgery. */
struct FrameDigest {
  std::uint64_t data = 0;   ///< checksum of images or points; 0 = unknown
  std::uint64_t labels = 0; ///< checksum of labels; 0 = unknown or without labels
};

/** \brief Record of a frame that was integrated into a map. */
struct FrameRecord {
  int number = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts;
  std::vector<std::pair<std::string, double>> seconds; ///< time of each stage [s]
  double domain_shift = std::numeric_limits<double>::quiet_NaN(); ///< see MappedFrame
  double timestamp = std::numeric_limits<double>::quiet_NaN();    ///< [s]; NaN: unknown
  FrameDigest digest; ///< of the frame's input
};

/** \brief Encodes a record without loss. Older records end before \a domain_shift, \a
 * timestamp or \a digest. */
std::vector<std::uint8_t> encodeFrameRecord(const FrameRecord& record);

/** \param[in] number of the frame
 * \throws BadInputException if the bytes are no record */
FrameRecord decodeFrameRecord(int number, const std::vector<std::uint8_t>& bytes);

} // namespace pcl_semantic
