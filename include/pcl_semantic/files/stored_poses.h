// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/frame_time.h>
#include <pcl_semantic/files/pose_doubts.h>

#include <Eigen/Geometry>

#include <optional>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The poses of a trajectory for the frames of a sensor. Poses in KITTI's format
 * are found by frame number, those in TUM's format by time.
 *
 * Between two timed poses the pose is interpolated: the position linearly, the rotation
 * by normalised quaternions. If their gap is too large, or the frame is before the
 * first or after the last one, the nearest pose counts, if it is within 0.01 s. */
class StoredPoses {
public:
  /** \param[in] T_camera0_camera pose of the images' camera in camera 0, if the
   * trajectory contains the poses of camera 0
   * \param[in] gap maximum time between two interpolated poses [s]; 0 = no
   * interpolation
   * \throws BadInputException if \a T_camera0_camera is not rigid
   * \throws InvalidParameterException if the gap is negative or not finite */
  explicit StoredPoses(
      StoredTrajectory trajectory,
      const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity(),
      double gap = default_gap);

  /** \brief A car's position between two poses 0.2 s apart is interpolated to 0.02 m,
   * on a highway to 0.06 m (doc/formats.md). */
  static constexpr double default_gap = 0.2;

  /** \brief T_world_sensor, the pose of a frame's sensor in the world [m].
   * \throws BadInputException that names the frame, if there is no pose for it */
  Eigen::Isometry3d pose(const FrameTime& frame) const;

  /** \brief Requires that all frames have a pose.
   * \throws BadInputException that names the first frame without one, the number of
   * such frames and the expected input */
  void requirePoses(const std::vector<FrameTime>& frames) const;

private:
  std::optional<Eigen::Isometry3d> find(const FrameTime& frame) const;
  std::optional<Eigen::Isometry3d> at(double time) const;
  std::string lackOf(const FrameTime& frame) const;

  StoredTrajectory trajectory_; // poses relative to the first camera 0
  Eigen::Isometry3d T_camera0_camera_;
  double gap_; // [s]
};

/** \brief Reads the poses of a trajectory file, see readTrajectory().
 * \param[in] T_camera0_camera see StoredPoses
 * \param[out] doubts if not null: the warnings of readTrajectory() are appended
 * \throws BadInputException as readTrajectory() */
StoredPoses readStoredPoses(
    const std::string& path, PoseFrame frame,
    const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity(),
    double gap = StoredPoses::default_gap, std::vector<std::string>* doubts = nullptr);

} // namespace pcl_semantic
