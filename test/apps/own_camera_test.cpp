// SPDX-License-Identifier: BSD-3-Clause

// Maps and poses of a camera that is not rectified, by --left, --right, --calibration.

#include "support/bad_case.h"
#include "support/map_agreement.h"
#include "support/mapped_street.h"
#include "support/own_camera.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Made once.
const std::string&
camera()
{
  static const TemporaryFolder folder;
  static const std::string path = [] {
    writeOwnCamera(folder.path("camera"));
    return folder.path("camera");
  }();
  return path;
}

const std::string options = " --crf none --max-depth 10 --voxel-size 0.25 ";

std::string
mapCommand(const std::string& camera, const std::string& output)
{
  return "map" + ownCamera(camera) + "--labels " + camera + "/labels --output " +
         output + options;
}

} // namespace

TEST(OwnCamera, GivesTheMapOfTheRectifiedStreet)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("street.map"), own = folder.path("own.map");
  succeed(mapOf(tinyStreet()) + " --output " + folder.path("street") + options +
          "--archive " + street);
  const std::string output = folder.path("own");
  succeed(mapCommand(camera(), output) + "--poses " + camera() +
          "/poses.txt --archive " + own);
  const Agreement agreement = agreementOf(own, street);
  // Poses of a camera that is turned by 4 degrees less give 76 %.
  EXPECT_GT(agreement.near, 0.93);
  EXPECT_GT(agreement.occupied, 500u);
  EXPECT_EQ(filesIn(output), filesOfMap({"000000", "000001", "000002"}));

  const Trajectory given = readKittiTrajectory(camera() + "/poses.txt");
  const Trajectory written = readKittiTrajectory(output + "/trajectory.txt");
  ASSERT_EQ(written.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(written[i].isApprox(given[i], 1e-6));
  const nlohmann::json inputs = readJson(output + "/summary.json")["inputs"];
  EXPECT_EQ(inputs["left"], camera() + "/left/*.png");
  EXPECT_EQ(inputs["right"], camera() + "/right/*.png");
  EXPECT_EQ(inputs["calibration"], camera() + "/stereo.yaml");
  EXPECT_FALSE(inputs.contains("sequence"));
}

TEST(OwnCamera, FindsItsPosesInTheImages)
{
  const TemporaryFolder folder;
  const std::string poses = folder.path("found.txt");
  succeed("odometry" + ownCamera(camera()) + poses);
  const Trajectory truth = readKittiTrajectory(camera() + "/poses.txt");
  const Trajectory found = readKittiTrajectory(poses);
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Isometry3d error = found[i].inverse() * truth[0].inverse() * truth[i];
    EXPECT_LT(error.translation().norm(), 0.15) << i; // of 1.7 m, by images of 64 rows
    EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.005) << i;
  }
  succeed(mapCommand(camera(), folder.path("own")) + "--poses odometry");
  EXPECT_GT(readLabelledCloud(folder.path("own/map.pcd")).cloud->size(), 500u);

  const std::string times = folder.write("times.txt", "5\n6\n7.5\n");
  succeed("odometry" + ownCamera(camera()) + "--format tum --times " + times + " " +
          folder.path("tum.txt"));
  EXPECT_NEAR(readTumTrajectory(folder.path("tum.txt")).at(2).time, 7.5, 1e-9);
}

TEST(OwnCamera, AnArchiveGoesOnWithTheSameFilesOnly)
{
  const TemporaryFolder folder;
  const std::string own = folder.path("camera");
  fs::copy(camera(), own, fs::copy_options::recursive);
  const std::string tail =
      "--poses " + own + "/poses.txt --archive " + folder.path("a.map") + " --resume";
  const std::string command = mapCommand(own, folder.path("own")) + tail;
  succeed(command);
  const std::string map = bytesOf(folder.path("own/map.pcd"));
  succeed(command);
  EXPECT_TRUE(bytesOf(folder.path("own/map.pcd")) == map);

  expectFails(replaceAll(command, "/right/*.png", "/right/shot*.png"), 3,
              "right was " + own + "/right/*.png, is ");
  std::ofstream(own + "/stereo.yaml", std::ios::app) << "rms: 0.3\n";
  expectFails(command, 3, "calibration was ");
}

TEST(OwnCamera, BadInputIsNamed)
{
  const auto copy = [](const std::string& street) { // instead of the street
    fs::remove_all(street);
    fs::copy(camera(), street, fs::copy_options::recursive);
  };
  const std::string map = "map --output OUT --labels STREET/labels",
                    own = ownCamera("STREET");
  expectAllFail({
      {2, "both a SEQUENCE ('", map + " STREET" + own, copy},
      {2, "patterns need quotes", map + replaceAll(own, "'", "") + "--frames 0:1",
       [&](const std::string& street) {
         copy(street);
         fs::remove(street + "/right/shot10.png");
         fs::remove(street + "/right/shot11.png");
         fs::remove(street + "/left/shot11.png");
       }},
      {2, "--left is missing", map + " --right R --calibration C", copy},
      {2, "--right is missing", map + " --left L --calibration C", copy},
      {2, "--calibration is missing", map + " --left L --right R", copy},
      {2, "--left is missing", map + " --times T", copy},
      {3, "stereo.yaml: cannot be read", map + own,
       [&](const std::string& street) {
         copy(street);
         fs::remove(street + "/stereo.yaml");
       }},
      {3, "left/*.png: has no poses.txt", map + own + "--poses sequence", copy},
      {2, "--left is a path that --output writes",
       "map --output OUT --labels STREET/labels --left 'OUT/overlay/*.png' --right R "
       "--calibration C",
       copy},
      {2, "both a SEQUENCE", "odometry STREET TEMP/a.txt" + own, copy},
      {2, "OUT.txt is missing", "odometry" + own, copy},
      {2, "stereo.yaml", "odometry STREET/stereo.yaml" + own, copy},
  });
}

} // namespace pcl_semantic
