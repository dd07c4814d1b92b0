// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/io/run_record.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief All inputs that affect the result of a run. */
struct MappingRun {
  /** Names and values: ("sequence", "kitti/05"). If a value is a file's path, the
   * file's bytes are included. */
  std::vector<std::pair<std::string, std::string>> inputs;
  std::vector<int> frames;            ///< numbers, in order
  std::optional<StereoCamera> camera; ///< none: clouds of a sensor without camera
  Eigen::Isometry3d T_camera0_camera = Eigen::Isometry3d::Identity();
  LabelSet label_set;
  MapperConfig config;
  bool finds_planes = false; ///< of the finished map; the map does not depend on it

  bool
  contains(int frame) const
  {
    return std::binary_search(frames.begin(), frames.end(), frame);
  }
};

/** \brief Describes a run as text, one "name: value" per line. The number of threads is
 * omitted because it has no effect. Runs with equal texts make equal maps. */
std::string describeRun(const MappingRun& run);

/** \brief Returns the first difference between two descriptions, for a message:
 * "voxel_size was 0.1, is 0.2"; empty if they are equal. */
std::string changeOfRun(const std::string& before, const std::string& now);

/** \brief Parses the parameters of a run from its description; missing ones have their
 * defaults.
 * \throws BadInputException at an invalid value */
MapperConfig configOf(const std::string& description);

/** \brief Returns the record of a frame, without its digest. */
FrameRecord recordOf(const MappedFrame& mapped);

} // namespace pcl_semantic
