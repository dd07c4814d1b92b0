// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/pipeline/frame_digest.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What the result of a run depends on. */
struct MappingRun {
  /** Names and values: ("sequence", "kitti/05"). Of a value that is the path of a file
   * its bytes count too. */
  std::vector<std::pair<std::string, std::string>> inputs;
  std::vector<int> frames;            ///< numbers, in order
  std::optional<StereoCamera> camera; ///< none: clouds of another sensor
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  LabelSet label_set;
  MapperConfig config;

  bool
  contains(int frame) const
  {
    return std::binary_search(frames.begin(), frames.end(), frame);
  }
};

/** \brief A run as text, one "name: value" a line, everything but the number of
 * threads, on which nothing depends. Two runs of the same text make the same map. */
std::string describeRun(const MappingRun& run);

/** \brief The first difference of two such texts, for a message: "voxel_size was 0.1,
 * is 0.2"; empty if there is none. */
std::string changeOfRun(const std::string& before, const std::string& now);

/** \brief The sensor of a run, by which poses of another trajectory are its own. */
struct RunSensor {
  /// Of the frames' camera or scanner in camera 0, whose poses a trajectory holds.
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  bool has_own_poses = false; ///< poses are the sensor's own, in a world with z up
};

/** \brief That of a run, from its text.
 * \throws BadInputException if the text does not say */
RunSensor sensorOf(const std::string& description);

/** \brief The parameters of a run, from its text; those that it does not name have
 * their defaults. \throws BadInputException if a value cannot be */
MapperConfig configOf(const std::string& description);

/** \brief What is kept of a frame that went into a map. */
struct FrameRecord {
  int number = 0;
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  ScanCounts counts;
  std::vector<std::pair<std::string, double>> seconds;            ///< by stage
  double domain_shift = std::numeric_limits<double>::quiet_NaN(); ///< see MappedFrame
  double timestamp = std::numeric_limits<double>::quiet_NaN(); ///< [s]; NaN: not known
  FrameDigest digest; ///< of what it was made from
};

/** \brief Without a digest. */
FrameRecord recordOf(const MappedFrame& mapped);

/** \brief A record as bytes, without loss; older ones end before \a domain_shift,
 * \a timestamp or \a digest. */
std::vector<std::uint8_t> encodeFrameRecord(const FrameRecord& record);

/** \param[in] number of the frame
 * \throws BadInputException if the bytes are not those of a record */
FrameRecord decodeFrameRecord(int number, const std::vector<std::uint8_t>& bytes);

} // namespace pcl_semantic
