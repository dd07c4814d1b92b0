// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whose poses a trajectory holds, and in which frame. */
enum class PoseFrame {
  first_camera, ///< camera 0 in the frame of the first one: x right, y down, z forward
  camera,       ///< a camera, x right, y down, z forward, in a world with z up
  sensor        ///< a sensor with any axes, in a world with z up
};

/** \brief Doubts about poses, which would turn the map: most of them upside
 * down, or tilted by more than 60 degrees (not of a sensor, whose axes are not known),
 * a way that climbs more than 10 m as no
 * road does, or steps of more than 30 m.
 * \param[in] has_quaternions whether they were read as x y z w: if w x y z would turn
 * them upright, that is said
 * \return a message for each, without the file */
std::vector<std::string> doubtsOf(const Trajectory& poses, PoseFrame frame,
                                  bool has_quaternions);

/** \brief The poses of a file, and what is doubtful of them. */
struct StoredTrajectory {
  std::string path;
  PoseFrame frame = PoseFrame::first_camera;
  TrajectoryFormat format = TrajectoryFormat::kitti;
  TimedTrajectory poses; ///< as they are there; those of KITTI's format at time 0
  /** \brief A line each, with the file's name: of doubtsOf(), and those of the readers.
   */
  std::vector<std::string> doubts;
};

/** \brief Reads a trajectory file, KITTI's or TUM's, whichever it is.
 * \throws BadInputException as readKittiTrajectory() and readTumTrajectory() */
StoredTrajectory readTrajectory(const std::string& path, PoseFrame frame);

} // namespace pcl_semantic
