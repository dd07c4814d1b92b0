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

/** \brief The poses of a trajectory that was read, for the frames of a sensor.
 * \param[in] T_camera0_camera the camera that takes the images, in camera 0, if the
 * file holds the poses of that */
std::unique_ptr<PoseSource>
posesOf(const StoredTrajectory& trajectory,
        const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity());

/** \brief The poses of a trajectory file, KITTI's or TUM's, whichever it is.
 * \param[in] T_camera0_camera the camera that takes the images, in camera 0, whose
 * poses the file holds
 * \param[out] doubts if not null: those of readTrajectory() are added to it
 * \throws BadInputException as readKittiTrajectory() and readTumTrajectory() */
std::unique_ptr<PoseSource>
readPoses(const std::string& path,
          const Eigen::Isometry3d& T_camera0_camera = Eigen::Isometry3d::Identity(),
          std::vector<std::string>* doubts = nullptr);

/** \brief The same of a file that holds the poses of the sensor itself, T_world_sensor
 * in a world with z up (x forward, if the map shall be seen as it was driven).
 * \param[in] frame sensor or camera: what is known of its axes, for the doubts */
std::unique_ptr<PoseSource> readSensorPoses(const std::string& path,
                                            PoseFrame frame = PoseFrame::sensor,
                                            std::vector<std::string>* doubts = nullptr);

/** \brief The poses that clouds bring, CloudFrame::viewpoint. */
class ViewpointPoses : public PoseSource {
public:
  /** \throws InvalidParameterException if the frame is no cloud */
  Eigen::Isometry3d pose(const SensorFrame& frame) override;
};

} // namespace pcl_semantic
