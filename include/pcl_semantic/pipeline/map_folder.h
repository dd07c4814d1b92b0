// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The contents of a map folder's summary.json. */
struct MapSummary {
  double voxel_size = 0.0;                          ///< [m]
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< of the points, world frame [m]
  /// Numbers of the frames in the map; none for the unfinished map in `live`.
  std::optional<std::vector<int>> frames;
  /// Whether the run finished. An interrupted run leaves the map of its frames so far.
  bool is_whole = true;
};

/** \brief Reads summary.json of a folder.
 * \throws BadInputException if it is missing or damaged, or the map does not exist
 * yet */
MapSummary readMapSummary(const std::string& folder);

} // namespace pcl_semantic
