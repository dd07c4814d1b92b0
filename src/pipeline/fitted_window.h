// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/frame_source.h>

#include <Eigen/Core>

#include <optional>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Distance from the camera that contains nearly all points of a recording with
 * depth images [m]: 99.9 % of each of ten frames, which are spread over the recording.
 * Reads these frames and then returns to the first one.
 * \return nothing without depths
 * \throws BadInputException if a frame cannot be read */
std::optional<double> reachOfDepths(FrameSource& source);

/** \brief A window with 2 m around this reach, at most as large as
 * MapParameters::withWindow() makes it for \a max_range [m]. */
Eigen::Vector3d windowOfReach(double reach, double max_range);

} // namespace pcl_semantic
