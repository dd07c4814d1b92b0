// SPDX-License-Identifier: BSD-3-Clause

// Maps and poses of a camera that is not rectified, by --left, --right, --calibration.

#include "support/bad_case.h"
#include "support/mapped_street.h"
#include "support/own_camera.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

constexpr double voxel = 0.25; // [m]

// Labels of the voxels of a map, by their place in the world.
std::map<std::array<int, 3>, std::uint32_t>
voxelsOf(const std::string& output)
{
  const LabelledCloud map = readLabelledCloud(output + "/map.pcd");
  const nlohmann::json origin = readJson(output + "/summary.json")["map_origin"];
  std::map<std::array<int, 3>, std::uint32_t> voxels;
  for (const auto& point : map.cloud->points) {
    const double world[] = {point.x + double(origin[0]), point.y + double(origin[1]),
                            point.z + double(origin[2])};
    voxels[{int(std::floor(world[0] / voxel)), int(std::floor(world[1] / voxel)),
            int(std::floor(world[2] / voxel))}] = point.label;
  }
  return voxels;
}

// The share of the voxels of `map` that have one of the same label at the same place or
// next to it in `other`.
double
shareFoundIn(const std::string& other, const std::string& map)
{
  const auto voxels = voxelsOf(map), others = voxelsOf(other);
  std::size_t found = 0;
  for (const auto& [at, label] : voxels) {
    bool is_there = false;
    for (int k = 0; k < 27 && !is_there; ++k) {
      const auto near =
          others.find({at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1, at[2] + k / 9 - 1});
      is_there = near != others.end() && near->second == label;
    }
    found += is_there;
  }
  EXPECT_GT(voxels.size(), 500u);
  return double(found) / double(voxels.size());
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
  const std::string camera = folder.path("camera");
  writeOwnCamera(camera);
  mapStreet(tinyStreet(), folder.path("street"), options);
  const std::string output = folder.path("own");
  succeed(mapCommand(camera, output) + "--poses " + camera + "/poses.txt");
  // Poses of a camera that is turned by 4 degrees less give 76 %.
  EXPECT_GT(shareFoundIn(folder.path("street"), output), 0.93);
  EXPECT_EQ(filesIn(output), filesOfMap({"000000", "000001", "000002"}));

  const Trajectory given = readKittiTrajectory(camera + "/poses.txt");
  const Trajectory written = readKittiTrajectory(output + "/trajectory.txt");
  ASSERT_EQ(written.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(written[i].isApprox(given[i], 1e-6));
  const nlohmann::json inputs = readJson(output + "/summary.json")["inputs"];
  EXPECT_EQ(inputs["left"], camera + "/left/*.png");
  EXPECT_EQ(inputs["right"], camera + "/right/*.png");
  EXPECT_EQ(inputs["calibration"], camera + "/stereo.yaml");
  EXPECT_FALSE(inputs.contains("sequence"));
}

TEST(OwnCamera, FindsItsPosesInTheImages)
{
  const TemporaryFolder folder;
  const std::string camera = folder.path("camera"), poses = folder.path("found.txt");
  writeOwnCamera(camera);
  succeed("odometry" + ownCamera(camera) + poses);
  const Trajectory truth = readKittiTrajectory(camera + "/poses.txt");
  const Trajectory found = readKittiTrajectory(poses);
  ASSERT_EQ(found.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Isometry3d error = found[i].inverse() * truth[0].inverse() * truth[i];
    EXPECT_LT(error.translation().norm(), 0.15) << i; // of 1.7 m, by images of 64 rows
    EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.005) << i;
  }
  succeed(mapCommand(camera, folder.path("own")) + "--poses odometry");
  EXPECT_GT(readLabelledCloud(folder.path("own/map.pcd")).cloud->size(), 500u);

  const std::string times = folder.write("times.txt", "5\n6\n7.5\n");
  succeed("odometry" + ownCamera(camera) + "--format tum --times " + times + " " +
          folder.path("tum.txt"));
  EXPECT_NEAR(readTumTrajectory(folder.path("tum.txt")).at(2).time, 7.5, 1e-9);
}

TEST(OwnCamera, AnArchiveGoesOnWithTheSameFilesOnly)
{
  const TemporaryFolder folder;
  const std::string camera = folder.path("camera");
  writeOwnCamera(camera);
  const std::string tail = "--poses " + camera + "/poses.txt --archive " +
                           folder.path("a.map") + " --resume";
  const std::string command = mapCommand(camera, folder.path("own")) + tail;
  succeed(command);
  const std::string map = bytesOf(folder.path("own/map.pcd"));
  succeed(command);
  EXPECT_TRUE(bytesOf(folder.path("own/map.pcd")) == map);

  expectFails(replaceAll(command, "/right/*.png", "/right/shot*.png"), 3,
              "right was " + camera + "/right/*.png, is ");
  std::ofstream(camera + "/stereo.yaml", std::ios::app) << "rms: 0.3\n";
  expectFails(command, 3, "calibration was ");
}

TEST(OwnCamera, BadInputIsNamed)
{
  const TemporaryFolder folder;
  const std::string own = folder.path("camera");
  writeOwnCamera(own);
  const auto copy = [&](const std::string& street) { // in the place of the street
    fs::remove_all(street);
    fs::copy(own, street, fs::copy_options::recursive);
  };
  const auto with = [&](const std::function<void(StereoRig&)>& change) {
    return [=](const std::string& street) {
      copy(street);
      StereoRig rig = readStereoRig(street + "/stereo.yaml");
      change(rig);
      writeRig(street + "/stereo.yaml", rig);
    };
  };
  const auto without = [&](const std::string& file) {
    return [=](const std::string& street) {
      copy(street);
      fs::remove_all(street + "/" + file);
    };
  };
  const std::string map = "map --output OUT --labels STREET/labels",
                    camera = ownCamera("STREET");
  expectAllFail({
      {"both", 2, "both a SEQUENCE ('", map + " STREET" + camera, copy},
      {"no quotes", 2, "patterns need quotes",
       map + replaceAll(camera, "'", "") + "--frames 0:1",
       [&](const std::string& street) {
         copy(street);
         fs::remove(street + "/right/shot10.png");
         fs::remove(street + "/right/shot11.png");
         fs::remove(street + "/left/shot11.png");
       }},
      {"no left", 2, "--left is missing", map + " --right R --calibration C", copy},
      {"no right", 2, "--right is missing", map + " --left L --calibration C", copy},
      {"no calibration", 2, "--calibration is missing", map + " --left L --right R",
       copy},
      {"times alone", 2, "--left is missing", map + " --times T", copy},
      {"no calibration file", 3, "stereo.yaml: cannot be read", map + camera,
       without("stereo.yaml")},
      {"no left files", 3, "left/*.png: no file matches", map + camera,
       without("left")},
      {"unequal", 3, "left/*.png: matches 3 files, but ", map + camera,
       without("right/shot11.png")},
      {"one lost", 3, "right/shot11.png: have different numbers", map + camera,
       without("right/shot10.png")},
      {"missing key", 3, "stereo.yaml: key 'T' is missing", map + camera,
       [&](const std::string& street) {
         copy(street);
         std::ofstream(street + "/stereo.yaml")
             << replaceAll(bytesOf(own + "/stereo.yaml"), "T:", "U:");
       }},
      {"size", 3, "stereo.yaml is the calibration of 416 x 64", map + camera,
       with([](StereoRig& rig) { rig.width *= 2; })},
      {"no baseline", 3, "stereo.yaml: T: is (0, 0, 0): the baseline is 0 m",
       map + camera, with([](StereoRig& rig) { rig.T.setZero(); })},
      {"swapped", 3, "T: is (", map + camera,
       with([](StereoRig& rig) { rig.T *= -1; })},
      {"millimetres", 3, "expected metres", map + camera,
       with([](StereoRig& rig) { rig.T *= 1000; })},
      {"truncated", 3, "left/shot9.png: the PNG image is damaged", map + camera,
       [&](const std::string& street) {
         copy(street);
         fs::resize_file(street + "/left/shot9.png", 900);
       }},
      {"few times", 3, "times.txt: has 1 times for 3 pairs",
       map + camera + "--times STREET/times.txt",
       [&](const std::string& street) {
         copy(street);
         std::ofstream(street + "/times.txt") << "0\n";
       }},
      {"no poses", 3, "left/*.png: has no poses.txt", map + camera + "--poses sequence",
       copy},
      {"in the output", 2, "--left is where --output puts its own files",
       "map --output OUT --labels STREET/labels --left 'OUT/overlay/*.png' --right R "
       "--calibration C",
       copy},
      {"odometry: both", 2, "both a SEQUENCE", "odometry STREET TEMP/a.txt" + camera,
       copy},
      {"odometry: no output", 2, "OUT.txt is missing", "odometry" + camera, copy},
      {"odometry: over the calibration", 2, "stereo.yaml",
       "odometry STREET/stereo.yaml" + camera, copy},
  });
}

} // namespace pcl_semantic
