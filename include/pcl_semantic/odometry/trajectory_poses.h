// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/pose_doubts.h>
#include <pcl_semantic/files/stored_poses.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The poses of a trajectory, see StoredPoses. */
class TrajectoryPoses : public PoseSource {
public:
  explicit TrajectoryPoses(StoredPoses poses) : poses_(std::move(poses)) {}

  Eigen::Isometry3d
  pose(const SensorFrame& frame) override
  {
    return poses_.pose(timeOf(frame));
  }

  void
  requirePoses(const std::vector<FrameTime>& frames) const override
  {
    poses_.requirePoses(frames);
  }

private:
  StoredPoses poses_;
};

/** \brief The poses of a trajectory for the frames of a sensor.
 * \param[in] T_camera0_camera pose of the images' camera in camera 0, if the file
 * contains the poses of camera 0
 * \param[in] gap see StoredPoses [s] */
std::unique_ptr<PoseSource>
posesOf(const StoredTrajectory& trajectory,
        const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity(),
        double gap = StoredPoses::default_gap);

/** \brief Reads poses of camera 0 from a trajectory file in KITTI's or TUM's format.
 * \param[in] T_camera0_camera pose of the images' camera in camera 0
 * \param[out] doubts if not null: the warnings of readTrajectory() are appended
 * \throws BadInputException as readKittiTrajectory() and readTumTrajectory() */
std::unique_ptr<PoseSource>
readPoses(const std::string& path,
          const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity(),
          double gap = StoredPoses::default_gap,
          std::vector<std::string>* doubts = nullptr);

/** \brief Reads the poses of the sensor itself, T_world_sensor in a world with z up (x
 * forward gives the usual view of the map).
 * \param[in] frame sensor or camera: the known axes, for plausibility warnings */
std::unique_ptr<PoseSource> readSensorPoses(const std::string& path,
                                            PoseFrame frame = PoseFrame::sensor,
                                            double gap = StoredPoses::default_gap,
                                            std::vector<std::string>* doubts = nullptr);

/** \brief The poses stored in clouds, CloudFrame::viewpoint. */
class ViewpointPoses : public PoseSource {
public:
  /** \throws InvalidParameterException if the frame is no cloud */
  Eigen::Isometry3d pose(const SensorFrame& frame) override;
};

} // namespace pcl_semantic
