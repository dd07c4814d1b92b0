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

// What an archive keeps of the run that made it: its description, a text of
// "name: value" lines, and a record of each frame.

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The sensor of a run, by which poses of another trajectory are its own. */
struct RunSensor {
  /// Of the frames' camera or scanner in camera 0, whose poses a trajectory holds.
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  bool has_own_poses = false; ///< poses are the sensor's own, in a world with z up
};

/** \brief That of a run, from its text.
 * \throws BadInputException if the text does not say */
RunSensor sensorOf(const std::string& description);

/** \brief Tells whether a frame is the one that a map was made from; it tells what was
 * changed by mistake, not what was forged. */
struct FrameDigest {
  std::uint64_t data = 0;   ///< of images or points; 0 = not known
  std::uint64_t labels = 0; ///< 0 = not known, or it has none
};

/** \brief Record of a frame that was integrated into a map. */
struct FrameRecord {
  int number = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts;
  std::vector<std::pair<std::string, double>> seconds;            ///< by stage
  double domain_shift = std::numeric_limits<double>::quiet_NaN(); ///< see MappedFrame
  double timestamp = std::numeric_limits<double>::quiet_NaN(); ///< [s]; NaN: not known
  FrameDigest digest; ///< of what it was made from
};

/** \brief A record as bytes, without loss; older ones end before \a domain_shift,
 * \a timestamp or \a digest. */
std::vector<std::uint8_t> encodeFrameRecord(const FrameRecord& record);

/** \param[in] number of the frame
 * \throws BadInputException if the bytes are not those of a record */
FrameRecord decodeFrameRecord(int number, const std::vector<std::uint8_t>& bytes);

} // namespace pcl_semantic
