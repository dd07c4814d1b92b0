// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <Eigen/Geometry>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Tells where the sensor was when a frame was taken: the left camera of a
 * stereo pair, or the sensor whose frame a cloud is in. */
class PoseSource {
public:
  virtual ~PoseSource() = default;

  /** \brief T_world_sensor, the pose of the frame's sensor in the world [m].
   * \throws BadInputException that names the frame, if there is no pose for it */
  virtual Eigen::Isometry3d pose(const SensorFrame& frame) = 0;

  /** \brief Before the first frame: makes sure that all frames have a pose, as far as
   * that can be known without their data.
   * \throws BadInputException that names the first frame without one, and says how many
   * lack one and what was expected */
  virtual void
  requirePoses(const std::vector<FrameTime>& /*frames*/) const
  {}

  /** \brief Frames so far whose poses are predicted, as nothing could be tracked. */
  virtual int
  lostFrames() const
  {
    return 0;
  }
};

/** \brief The pose of a frame whose data is not there, of a source that asks for number
 * and time alone, as those of files do. \throws as PoseSource::pose() */
inline Eigen::Isometry3d
poseAt(PoseSource& poses, const FrameTime& time)
{
  CloudFrame frame;
  static_cast<FrameTime&>(frame) = time;
  return poses.pose(frame);
}

} // namespace pcl_semantic
