// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Poses as KITTI writes them: row = frame number, camera 0 (x right, y down,
 * z forward) in the frame of the first camera 0 [m]. */
using Trajectory = std::vector<Eigen::Isometry3d>;

/** \brief A pose and when it was. */
struct TimedPose {
  double time = 0.0;                                      ///< [s]
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity(); ///< as in Trajectory
};

/** \brief Poses by time, in its order; any may be missing. */
using TimedTrajectory = std::vector<TimedPose>;

enum class TrajectoryFormat {
  kitti, ///< 12 numbers a row, the upper 3 x 4 of the pose; comments before the first
  tum    ///< time, translation, quaternion (x y z w); lines with # are comments
};

/** \brief Which format a file has, by the numbers of its first line that holds any.
 * \throws BadInputException if it is neither */
TrajectoryFormat trajectoryFormatOf(const std::string& path);

/** \brief Reads a KITTI trajectory, also as ORB-SLAM's SaveTrajectoryKITTI writes it.
 *
 * Rotations off by rounding are made orthonormal again, with a doubt if it is more
 * than that of text (1e-4); by more than 1e-2 they are refused.
 * \param[out] doubts if not null: a line is added to it if poses were made rigid
 * \throws BadInputException with the line, at a wrong count, a non-finite number or a
 * matrix that is no rotation */
Trajectory readKittiTrajectory(const std::string& path,
                               std::vector<std::string>* doubts = nullptr);

/** \brief Writes a KITTI trajectory, so that reading it gives the same numbers.
 * \throws OutputException */
void writeKittiTrajectory(const std::string& path, const Trajectory& trajectory);

/** \brief Reads a TUM trajectory, also as ORB-SLAM's SaveTrajectoryTUM and
 * SaveKeyFrameTrajectoryTUM write it. Times beyond 1e17 are nanoseconds.
 *
 * Quaternions whose length is off by more than 1e-4 are made 1 with a doubt, by more
 * than 1e-2 refused.
 * \param[out] doubts if not null: a line is added to it if poses were made rigid
 * \throws BadInputException with the line, at a wrong count, a non-finite number, a
 * quaternion that is no rotation or times that do not grow */
TimedTrajectory readTumTrajectory(const std::string& path,
                                  std::vector<std::string>* doubts = nullptr);

/** \brief Writes a TUM trajectory: times to the nanosecond.
 * \throws OutputException */
void writeTumTrajectory(const std::string& path, const TimedTrajectory& trajectory);

/** \brief The pose whose time is nearest, or null if none is within \a tolerance [s].
 */
const TimedPose* findPose(const TimedTrajectory& trajectory, double time,
                          double tolerance);

/** \brief The times of a file as KITTI's times.txt: one a row [s], row = frame number.
 * Times beyond 1e17 are nanoseconds.
 * \throws BadInputException with the line */
std::vector<double> readTimes(const std::string& path);

} // namespace pcl_semantic
