// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/map/map_parameters.h>

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What a map archive is from its beginning. */
struct ArchiveHeader {
  LabelSet label_set;
  MapParameters parameters;
  std::string configuration; ///< what the map is made from and with, a line each
};

/** \brief What a map archive says of the map at its last commit. */
struct ArchiveState {
  Eigen::Vector3d cloud_origin = Eigen::Vector3d::Zero(); ///< world frame [m]
  bool finished = false;        ///< nothing is missing; else the run can go on
  std::uint64_t blocks = 0;     ///< set by MapArchive::commit
  std::uint64_t key_sum = 0;    ///< of the indices of the blocks; likewise
  std::uint64_t frames = 0;     ///< likewise
  std::int64_t last_frame = -1; ///< number of the last of them; likewise
};

} // namespace pcl_semantic
