// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/trajectory_file.h>

#include <string>

namespace pcl_semantic {

/** \brief The poses of a trajectory file of either format, without the warning that its
 * reader has printed before. \throws BadInputException as readKittiTrajectory() */
Trajectory readPosesAgain(const std::string& path);

} // namespace pcl_semantic
