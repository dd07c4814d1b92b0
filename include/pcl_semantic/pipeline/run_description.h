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

/** \brief All inputs of a run that its result depends on. */
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

/** \brief The parameters of a run, from its text; those that it does not name have
 * their defaults. \throws BadInputException if a value cannot be */
MapperConfig configOf(const std::string& description);

/** \brief The record of a frame, without its digest. */
FrameRecord recordOf(const MappedFrame& mapped);

} // namespace pcl_semantic
