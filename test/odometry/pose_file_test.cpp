// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

#include <gtest/gtest.h>

using namespace pcl_semantic;

namespace {

StereoFrame
frameOf(int number, double time)
{
  StereoFrame frame;
  frame.number = number;
  frame.timestamp = time;
  return frame;
}

} // namespace

TEST(PoseFile, ReadsEitherFormat)
{
  const TemporaryFolder folder;
  const std::string kitti =
      folder.write("kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 2\n");
  const std::string tum =
      folder.write("tum.txt", "# made by hand\n5 0 0 0 0 0 0 1\n6 0 0 2 0 0 0 1\n");
  // 0.1 m right of camera 0, which drove 2 m forward: world x forward, y left.
  const Eigen::Isometry3d T_camera0_camera(Eigen::Translation3d(0.1, 0.0, 0.0));
  for (const std::string& path : {kitti, tum}) {
    const auto poses = readPoses(path, T_camera0_camera);
    const Eigen::Isometry3d pose = poses->pose(frameOf(1, 6.0));
    EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(2.0, -0.1, 0.0))) << path;
    EXPECT_TRUE(
        readPoses(path)->pose(frameOf(0, 5.0)).isApprox(worldFromFirstCamera()));
    const std::string message = thrownMessage<BadInputException>([&] {
      poses->requirePoses({{0, 5.0}, {7, 12.0}});
    });
    EXPECT_NE(message.find(path), std::string::npos) << message;
  }
}

TEST(PoseFile, RefusesWhatIsNeither)
{
  const TemporaryFolder folder;
  EXPECT_THROW(readPoses(folder.path("nowhere.txt")), BadInputException);
  EXPECT_THROW(readPoses(folder.write("nine.txt", "1 2 3 4 5 6 7 8 9\n")),
               BadInputException);
}
