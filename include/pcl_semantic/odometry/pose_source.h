// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <Eigen/Geometry>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Gives the sensor pose at the time of a frame: of the left camera of a stereo
 * pair, or of the frame of a cloud. */
class PoseSource {
public:
  virtual ~PoseSource() = default;

  /** \brief T_world_sensor, the pose of the frame's sensor in the world [m].
   * \throws BadInputException that names the frame, if there is no pose for it */
  virtual Eigen::Isometry3d pose(const SensorFrame& frame) = 0;

  /** \brief Checks before the first frame that all frames have a pose, as far as
   * possible without their data.
   * \throws BadInputException that names the first frame without one, the number of
   * such frames and the expected input */
  virtual void
  requirePoses(const std::vector<FrameTime>& /*frames*/) const
  {}

  /** \brief Number of frames so far with a predicted pose, because tracking failed. */
  virtual int
  lostFrames() const
  {
    return 0;
  }
};

/** \brief The pose of a frame without its data, for sources that need only number and
 * time, such as files.
 * \throws as PoseSource::pose() */
inline Eigen::Isometry3d
poseAt(PoseSource& poses, const FrameTime& time)
{
  CloudFrame frame;
  static_cast<FrameTime&>(frame) = time;
  return poses.pose(frame);
}

} // namespace pcl_semantic
