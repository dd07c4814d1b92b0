// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Poses in KITTI's convention: row = frame number, camera 0 (x right, y down, z
 * forward) in the frame of the first camera 0 [m]. */
using Trajectory = std::vector<Eigen::Isometry3d>;

/** \brief A pose with its timestamp. */
struct TimedPose {
  double time = 0.0;                                      ///< [s]
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity(); ///< as in Trajectory
};

/** \brief Poses in ascending order of time, possibly with gaps. */
using TimedTrajectory = std::vector<TimedPose>;

enum class TrajectoryFormat {
  kitti, ///< 12 numbers per row, the upper 3 x 4 of the pose; comments before the first
  tum    ///< time, translation, quaternion (x y z w); lines with # are comments
};

/** \brief Detects the format of a file from the count of numbers in its first data
 * line.
 * \throws BadInputException if it is neither */
TrajectoryFormat trajectoryFormatOf(const std::string& path);

/** \brief Reads a KITTI trajectory, also the output of ORB-SLAM's SaveTrajectoryKITTI.
 *
 * Rotations with rounding errors are orthonormalised, with a warning for errors above
 * 1e-4; errors above 1e-2 are refused.
 * \param[out] doubts if not null: a line is appended if poses were made rigid
 * \throws BadInputException with the line, for a wrong count, a non-finite number or a
 * matrix that is no rotation */
Trajectory readKittiTrajectory(const std::string& path,
                               std::vector<std::string>* doubts = nullptr);

/** \brief Writes a KITTI trajectory; reading it returns the same numbers.
 * \throws OutputException */
void writeKittiTrajectory(const std::string& path, const Trajectory& trajectory);

/** \brief Reads a TUM trajectory, also the output of ORB-SLAM's SaveTrajectoryTUM and
 * SaveKeyFrameTrajectoryTUM. Times beyond 1e17 are nanoseconds.
 *
 * Quaternions are normalised, with a warning if their length is off by more than 1e-4;
 * errors above 1e-2 are refused.
 * \param[out] doubts if not null: a line is appended if poses were made rigid
 * \throws BadInputException with the line, for a wrong count, a non-finite number, a
 * quaternion that is no rotation, or times that do not increase */
TimedTrajectory readTumTrajectory(const std::string& path,
                                  std::vector<std::string>* doubts = nullptr);

/** \brief Writes a TUM trajectory: times to the nanosecond.
 * \throws OutputException */
void writeTumTrajectory(const std::string& path, const TimedTrajectory& trajectory);

/** \brief The pose nearest in time, or null if none is within \a tolerance [s]. */
const TimedPose* findPose(const TimedTrajectory& trajectory, double time,
                          double tolerance);

/** \brief Reads the times of a file such as KITTI's times.txt: one per row [s], row =
 * frame number. Times beyond 1e17 are nanoseconds.
 * \throws BadInputException with the line */
std::vector<double> readTimes(const std::string& path);

} // namespace pcl_semantic
