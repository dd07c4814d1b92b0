// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/evaluation/trajectory_error.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How far an estimated trajectory is from the true one. */
struct TrajectoryErrors {
  std::size_t poses = 0;
  double length = 0.0;               ///< of the true one [m]
  std::vector<SegmentErrors> pieces; ///< by length, the last of all together
  AbsoluteErrors from_start;
  AbsoluteErrors aligned;
};

/** \brief A table for people. */
std::string trajectoryTable(const TrajectoryErrors& errors);

/** \brief Translation in percent, rotation in degrees/m, distances in metres; null
 * where there are no pieces. */
std::string trajectoryJson(const TrajectoryErrors& errors);

} // namespace pcl_semantic
