// SPDX-License-Identifier: BSD-3-Clause
#include "support/bad_case.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

TEST(OdometryTool, WritesBothFormats)
{
  const TemporaryFolder folder;
  const std::string kitti = folder.path("kitti.txt"), tum = folder.path("tum.txt");
  succeed("odometry " + tinyStreet() + " " + kitti + " --report " +
          folder.path("report.csv"));
  succeed("odometry " + tinyStreet() + " " + tum + " --format tum");
  const Trajectory rows = readKittiTrajectory(kitti);
  const TimedTrajectory timed = readTumTrajectory(tum);
  const Trajectory truth = readKittiTrajectory(tinyStreet() + "/poses.txt");
  ASSERT_EQ(rows.size(), 3u);
  ASSERT_EQ(timed.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(rows[i].isApprox(timed[i].pose, 1e-9));
    EXPECT_NEAR(timed[i].time, 0.1 * double(i), 1e-9);
    EXPECT_LT((rows[i].translation() - truth[i].translation()).norm(), 0.1);
  }
  EXPECT_EQ(linesOf(folder.path("report.csv")).size(), 4u);
}

TEST(OdometryTool, FollowsAnRgbdCameraThroughARoom)
{
  const TemporaryFolder folder;
  const std::string room = folder.path("room"), poses = folder.path("poses.txt");
  succeed("synthesize " + room + " --scene room --depth-noise 0");
  succeed("odometry --rgbd " + room + " --calibration " + room + "/camera.yaml " +
          poses);
  const Trajectory truth = readKittiTrajectory(room + "/poses.txt");
  const Trajectory found = readKittiTrajectory(poses);
  ASSERT_EQ(found.size(), 40u);
  double path = 0.0;
  for (std::size_t i = 1; i < 40; ++i)
    path += (truth[i].translation() - truth[i - 1].translation()).norm();
  const Eigen::Isometry3d moved =
      truth[0] * found[0].inverse() * found[39]; // in the world of the truth
  EXPECT_GT(path, 7.0);
  EXPECT_LT((moved.translation() - truth[39].translation()).norm(), 0.01 * path);
}

TEST(OdometryTool, SaysWhatWasLost)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  for (const char* const side : {"/image_2/", "/image_3/"})
    writePng(street + side + "000002.png",
             cv::Mat(64, 208, CV_8UC3, cv::Scalar::all(90)));
  const std::string text = succeed("odometry " + street + " " + folder.path("out.txt"));
  EXPECT_TRUE(
      holds(text, "warning: 1 of 3 frames could not be tracked, the first is 2"));
  EXPECT_EQ(readKittiTrajectory(folder.path("out.txt")).size(), 3u);
}

TEST(OdometryTool, BlankImagesGiveNoTrajectoryAndNoMap)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street");
  copyStreet(street);
  blankImages(street);
  for (const auto& [command, product] :
       {std::pair("odometry " + street + " ", "out.txt"),
        {mapOf(street) + " --poses odometry --crf none --output ", "map"}}) {
    const ToolResult result = runTool(command + folder.path(product));
    EXPECT_EQ(result.code, 3);
    EXPECT_TRUE(holds(result.text, "warning: frame 0: both images are blank"));
    EXPECT_TRUE(holds(result.text, "street: no frame could be tracked\n"));
  }
  EXPECT_FALSE(fs::exists(folder.path("out.txt")));
  EXPECT_FALSE(fs::exists(folder.path("map/map.pcd")));
}

TEST(MapTool, FindsItsPosesByOdometryWithoutPosesTxt)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street"), out = folder.path("out");
  copyStreet(street);
  const Trajectory truth = readKittiTrajectory(street + "/poses.txt");
  fs::remove(street + "/poses.txt");
  succeed(mapOf(street) + " --crf none --output " + out);
  EXPECT_TRUE(holds(bytesOf(out + "/summary.json"), "\"poses\": \"odometry\""));
  const Trajectory driven = readKittiTrajectory(out + "/trajectory.txt");
  ASSERT_EQ(driven.size(), 3u);
  EXPECT_LT((driven[2].translation() - truth[2].translation()).norm(), 0.1);
}

TEST(MapTool, TakesTumTrajectories)
{
  const TemporaryFolder folder;
  const Trajectory truth = readKittiTrajectory(tinyStreet() + "/poses.txt");
  writeTumTrajectory(folder.path("tum.txt"), {{0.0, truth[0]}, {0.1, truth[1]}});
  const std::string command = mapOf(tinyStreet()) + " --crf none --poses " +
                              folder.path("tum.txt") + " --output " +
                              folder.path("out");
  succeed(command + " --frames 0:2");
  expectFails(command, 3, "the time of frame 2");
}

// Faults of the poses are reported before any output; of a file's own its reader's
// tests have more.
TEST(BadInput, Trajectories)
{
  const std::string rest = "1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 2 0 1 0 0 0 0 1 0\n";
  const TemporaryFolder folder;
  const std::string out = folder.path("out"), archive = folder.path("a.db");
  for (const auto& [text, says] : std::vector<std::pair<std::string, const char*>>{
           {"", "a.txt: holds no pose"},
           {rest, "a.txt: has 2 poses, none for frame 2 (row = frame number); 1 of 3"},
           {"1 0 0 0 0 1 0 0 0 0 1 inf\n" + rest, "a.txt line 1: 'inf'"},
           {"-1 0 0 0 0 -1 0 0 0 0 -1 0\n", "a.txt line 1: the left 3 x 3 block"},
           {"0 0 0 0 0 0 0 1\n0.3 0 0 0 0 0 0 1\n",
            "a.txt: has no pose within 0.01 s of 0.1 s, the time of frame 1, nor two "
            "around it within 0.2 s; its times are from 0 to 0.3 s; 2 of 3 frames lack "
            "one"},
           {"1403636579763555584 0 0 0 0 0 0 1\n",
            "from 1403636579.76356 to 1403636579.76356 s; 3 of 3 frames lack one"},
           {"1 0 0 0 0 0 0 1\n0 0 0 0 0 0 0 1\n",
            "a.txt line 2: time is not later than"},
           {"0 0 0 0 0 0 0 1.1\n", "a.txt line 1: the quaternion has length 1.1"}}) {
    SCOPED_TRACE(text);
    const std::string path = folder.write("a.txt", text);
    const ToolResult result = runTool(mapOf(tinyStreet()) + " --poses " + path +
                                      " --output " + out + " --archive " + archive);
    EXPECT_EQ(result.code, 3);
    EXPECT_EQ(result.text.rfind("pcl_semantic_map: " + path, 0), 0u);
    EXPECT_TRUE(holds(result.text, says));
    EXPECT_EQ(std::count(result.text.begin(), result.text.end(), '\n'), 1);
    EXPECT_FALSE(fs::exists(out));
    EXPECT_FALSE(fs::exists(archive));
  }
}

TEST(MapTool, MakesPosesRigidWithOneWarning)
{
  const TemporaryFolder folder;
  std::string text = "# by hand\r\n";
  for (const char* const z : {"0", "0.85", "1.7"})
    text += std::string("0.998 0 0 0 0 1 0 0 0 0 1 ") + z + "\r\n";
  const std::string said =
      succeed(mapOf(tinyStreet()) + " --crf none --poses " +
              folder.write("a.txt", text) + " --output " + folder.path("out"));
  EXPECT_EQ(said.rfind("pcl_semantic_map: warning: " + folder.path("a.txt") +
                           ": 3 of 3 poses were not exactly rigid and were corrected, "
                           "the first in line 2\nmap: ",
                       0),
            0u)
      << said;
  for (const Eigen::Isometry3d& pose :
       readKittiTrajectory(folder.path("out/trajectory.txt")))
    EXPECT_TRUE(pose.linear().isIdentity(1e-12));
}

TEST(BadUsage, OdometryTool)
{
  const std::string poses = " STREET/poses.txt ";
  expectAllFail({
      {2, "expected a SEQUENCE, or --left", "odometry"},
      {2, "OUT.txt is missing", "odometry STREET"},
      {2, "--format is 'csv'", "odometry STREET OUT --format csv"},
      {2, "features is 1", "odometry STREET OUT --features 1"},
      {2, "window is 0", "odometry STREET OUT --window 0"},
      {2, "threads is -1", "odometry STREET OUT --threads -1"},
      {2, "poses.txt", "odometry STREET" + poses},
      {2, "use --format tum", "odometry STREET OUT --frames 1:3"},
      {3, "has no frame in 7:9", "odometry STREET OUT --frames 7:9"},
      {3, "none: is no folder", "odometry STREET/none OUT"},
      {3, "frame 0: both images are blank", "odometry STREET OUT --strict",
       blankImages},
      {5, "calib.txt", "odometry STREET STREET/calib.txt/x"},
      {2, "--archive needs poses from a file",
       "--labels STREET/labels --poses odometry --archive TEMP/a.db"},
      {2, "--archive needs poses from a file",
       "--labels STREET/labels --archive TEMP/a.db",
       [](const std::string& street) { fs::remove(street + "/poses.txt"); }},
  });
}

} // namespace pcl_semantic
