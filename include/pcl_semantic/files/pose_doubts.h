// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Sensor and world frame of a trajectory's poses. */
enum class PoseFrame {
  first_camera, ///< camera 0 (x right, y down, z forward) in its first frame
  camera,       ///< camera (x right, y down, z forward) in a world with z up
  sensor        ///< sensor with any axes in a world with z up
};

/** \brief Warnings about implausible poses: most of them upside down or tilted by more
 * than 60 degrees (not for PoseFrame::sensor), a climb of more than 10 m that is too
 * steep for a road, or steps of more than 30 m.
 * \param[in] has_quaternions the poses were read as x y z w; the warning then tells if
 * the order w x y z would turn them upright
 * \return one message per warning, without the file name */
std::vector<std::string> doubtsOf(const Trajectory& poses, PoseFrame frame,
                                  bool has_quaternions);

/** \brief The poses of a file and warnings about them. */
struct StoredTrajectory {
  std::string path;
  PoseFrame frame = PoseFrame::first_camera;
  TrajectoryFormat format = TrajectoryFormat::kitti;
  TimedTrajectory poses; ///< as stored; poses in KITTI's format have time 0
  /** \brief Warnings of doubtsOf() and of the readers, one line each, with the file
   * name. */
  std::vector<std::string> doubts;
};

/** \brief Reads a trajectory file in KITTI's or TUM's format.
 * \throws BadInputException as readKittiTrajectory() and readTumTrajectory() */
StoredTrajectory readTrajectory(const std::string& path, PoseFrame frame);

} // namespace pcl_semantic
