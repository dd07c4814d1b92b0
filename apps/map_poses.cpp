// SPDX-License-Identifier: BSD-3-Clause
#include "map_poses.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

namespace pcl_semantic::tool {

std::string
choosePoses(const MapArguments& arguments, const FrameSequence& sequence)
{
  if (arguments.poses != "auto" && arguments.poses != "sequence")
    return arguments.poses;
  const std::string path = sequence.posesPath();
  if (!path.empty())
    return path;
  if (arguments.poses == "sequence")
    PCL_THROW_EXCEPTION(BadInputException,
                        arguments.sequence.name()
                            << ": has no poses.txt; give a trajectory with --poses");
  if (!arguments.archive.path.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "--archive needs poses from a file, but "
                            << arguments.sequence.name()
                            << " has no poses.txt; write them with "
                               "pcl_semantic_odometry and give them with --poses");
  return "odometry";
}

std::unique_ptr<PoseSource>
makePoses(const std::string& chosen, const FrameSequence& sequence)
{
  const Eigen::Isometry3d& T_camera0_camera = sequence.T_camera0_camera();
  if (chosen == "odometry")
    return std::make_unique<StereoOdometry>(sequence.camera(), T_camera0_camera);
  return readPoses(chosen, T_camera0_camera);
}

} // namespace pcl_semantic::tool
