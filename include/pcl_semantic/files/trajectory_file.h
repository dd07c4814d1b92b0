// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Poses in KITTI's convention, indexed by frame number. A pose is that of
 * camera 0 (x right, y down, z forward) in the frame of the first camera 0 [m]. */
using Trajectory = std::vector<Eigen::Isometry3d>;

/** \brief A pose with its timestamp. */
struct TimedPose {
  double time = 0.0;                                      ///< [s]
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity(); ///< in the file's world [m]
};

/** \brief Poses in ascending order of time, possibly with gaps. */
using TimedTrajectory = std::vector<TimedPose>;

enum class TrajectoryFormat {
  /// 12 numbers per row: the upper 3 x 4 of a pose. Lines with # may precede the rows.
  kitti,
  /// 8 numbers per row: time, translation, quaternion (x y z w). Lines with # are
  /// comments.
  tum
};

/** \brief Detects the format of a file from the count of numbers in its first data
 * line.
 * \throws BadInputException if the file has another format or contains no pose */
TrajectoryFormat trajectoryFormatOf(const std::string& path);

/** \brief Reads a KITTI trajectory. ORB-SLAM's SaveTrajectoryKITTI writes such files.
 *
 * Rotations with rounding errors are orthonormalised. The error is the Frobenius norm
 * of R R^T - 1. Errors above 1e-2 are refused.
 * \param[out] doubts null = none; a line is appended if an error is above 1e-4
 * \throws BadInputException with the line, for a wrong count, a non-finite number or a
 * matrix that is no rotation */
Trajectory readKittiTrajectory(const std::string& path,
                               std::vector<std::string>* doubts = nullptr);

/** \brief Reads a file with the 4 x 4 matrix of one pose, as 7-Scenes and ScanNet have
 * one for each frame. Rotations are corrected as in readKittiTrajectory().
 * \return a pose of NaN if a number is not finite: the camera was lost there
 * \throws BadInputException for another count of numbers, another last row than
 * 0 0 0 1, or a matrix that is no rotation */
Eigen::Isometry3d readPoseFile(const std::string& path,
                               std::vector<std::string>* doubts = nullptr);

/** \brief Writes a KITTI trajectory with all digits of the numbers.
 * \throws BadInputException if a pose is not rigid
 * \throws OutputException if the file cannot be written */
void writeKittiTrajectory(const std::string& path, const Trajectory& trajectory);

/** \brief Reads a TUM trajectory. ORB-SLAM's SaveTrajectoryTUM and
 * SaveKeyFrameTrajectoryTUM write such files. Times from 1e17 on are nanoseconds.
 *
 * Quaternions are normalised. The error is the difference of their length from 1.
 * Errors above 1e-2 are refused.
 * \param[out] doubts null = none; a line is appended if an error is above 1e-4
 * \throws BadInputException with the line, for a wrong count, a non-finite number, a
 * quaternion that is no rotation, or times that do not increase */
TimedTrajectory readTumTrajectory(const std::string& path,
                                  std::vector<std::string>* doubts = nullptr);

/** \brief Writes a TUM trajectory. Times have nine decimals [s], other numbers all
 * digits.
 * \throws BadInputException if a pose is not rigid
 * \throws OutputException if the file cannot be written */
void writeTumTrajectory(const std::string& path, const TimedTrajectory& trajectory);

/** \brief The pose nearest in time.
 * \param[in] time, tolerance [s]
 * \return null if no pose is within the tolerance. In a tie, the later pose */
const TimedPose* findPose(const TimedTrajectory& trajectory, double time,
                          double tolerance);

/** \brief Reads the times of a file such as KITTI's times.txt [s]. Row n, from 0, is
 * the time of frame n. Times from 1e17 on are nanoseconds.
 * \throws BadInputException with the line, if a row is not one number or the times do
 * not increase */
std::vector<double> readTimes(const std::string& path);

} // namespace pcl_semantic
