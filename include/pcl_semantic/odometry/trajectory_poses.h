// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/odometry/pose_doubts.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <memory>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Poses from a trajectory of camera 0, in KITTI's frames. */
class StoredPoses : public PoseSource {
public:
  Eigen::Isometry3d pose(const SensorFrame& frame) override;

  void requirePoses(const std::vector<FrameTime>& frames) const override;

protected:
  StoredPoses(const Eigen::Isometry3d& T_camera0_camera, std::string name);

  /** \return the camera-0 pose of a frame, or null */
  virtual const Eigen::Isometry3d* find(const FrameTime& frame) const = 0;

  /** \brief Says that a frame has none, as an error message. */
  virtual std::string lackOf(const FrameTime& frame) const = 0;

  std::string name_; ///< of the trajectory's file

private:
  Eigen::Isometry3d T_camera0_camera_;
};

/** \brief Poses from a TUM trajectory, found by the time of a frame. */
class TimedPoses : public StoredPoses {
public:
  /** \param[in] trajectory camera-0 poses, see readTumTrajectory
   * \param[in] T_camera0_camera the camera that takes the images, in camera 0
   * \param[in] name its file, for messages
   * \param[in] tolerance how far a pose's time may be from its frame's [s] */
  TimedPoses(TimedTrajectory trajectory, const Eigen::Isometry3d& T_camera0_camera,
             std::string name = "the trajectory", double tolerance = 0.01);

private:
  const Eigen::Isometry3d* find(const FrameTime& frame) const override;

  std::string lackOf(const FrameTime& frame) const override;

  TimedTrajectory trajectory_;
  double tolerance_; ///< [s]
};

/** \brief Poses from a KITTI trajectory: row n is the pose of camera 0 at frame n. */
class TrajectoryPoses : public StoredPoses {
public:
  /** \param[in] trajectory camera-0 poses, see readKittiTrajectory
   * \param[in] T_camera0_camera the camera that takes the images, in camera 0
   * \param[in] name its file, for messages */
  TrajectoryPoses(Trajectory trajectory, const Eigen::Isometry3d& T_camera0_camera,
                  std::string name = "the trajectory");

private:
  const Eigen::Isometry3d* find(const FrameTime& frame) const override;

  std::string lackOf(const FrameTime& frame) const override;

  Trajectory trajectory_;
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
