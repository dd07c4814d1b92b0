// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_arguments.h"

#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/odometry/stereo_odometry.h>

#include <memory>

namespace pcl_semantic::tool {

/** \brief Where the poses of a run come from: the path of a trajectory, or "odometry".
 * \throws BadInputException if the sequence shall have a trajectory and has none
 * \throws InvalidParameterException if the run is archived and has no trajectory */
std::string choosePoses(const MapArguments& arguments, const FrameSequence& sequence);

/** \brief Opens what choosePoses() has chosen. */
std::unique_ptr<PoseSource> makePoses(const std::string& chosen,
                                      const FrameSequence& sequence);

} // namespace pcl_semantic::tool
