// SPDX-License-Identifier: BSD-3-Clause
#include "support/mapped_street.h"
#include "support/rgbd_street.h"

#include <pcl_semantic/files/trajectory_file.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <string>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

class LiveMap : public testing::Test {
protected:
  // A command for the shell: maps pairs in the background, and prints into the log.
  std::string
  start(const std::string& pairs, const std::string& labels = tinyStreet() + "/labels",
        const std::string& more = "") const
  {
    return PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_live " + pairs + " --labels " +
           labels + " --verbose --output " + map + more + " >" + log + " 2>&1 & ";
  }

  // For the shell: waits until its last run has printed the text.
  std::string
  waitFor(const std::string& text) const
  {
    return "until grep -q \"" + text + "\" " + log +
           "; do kill -0 $! || exit 1; sleep 0.05; done; ";
  }

  const TemporaryFolder folder;
  const std::string street = folder.path("street"), map = folder.path("map");
  const std::string log = folder.path("log");
};

} // namespace

// Another program fills the folder and ends the run after all pairs were mapped. The
// run has restarted itself meanwhile, with threads that sleep soon.
TEST_F(LiveMap, GrowsWithAFolderUntilItIsInterrupted)
{
  fs::create_directories(street + "/image_2");
  fs::create_directories(street + "/image_3");
  std::string fill = "cp " + tinyStreet() + "/calib.txt " + street + "; ";
  for (const std::string frame : {"0", "1", "2"}) {
    for (const std::string side : {"2", "3"})
      fill += "cp " + tinyStreet() + "/image_" + side + "/00000" + frame + ".png " +
              street + "/image_" + side + "; ";
    fill += waitFor("live: frame " + frame);
  }
  const ToolResult result =
      runShell("env -u OMP_WAIT_POLICY -u GOMP_SPINCOUNT " + start(street) +
               waitFor("waiting for calib.txt") + fill +
               "tr '\\0' '\\n' </proc/$!/environ | grep GOMP; cat /proc/$!/comm; "
               "kill -INT $!; wait $!; code=$?; cat " +
               log + "; exit $code");
  EXPECT_EQ(result.code, 0) << result.text;
  EXPECT_TRUE(holds(result.text, "frames: 3"));
  EXPECT_TRUE(holds(result.text, "dropped: 0"));
  EXPECT_TRUE(holds(result.text, "GOMP_SPINCOUNT=1000"));
  EXPECT_TRUE(holds(result.text, "pcl_semantic_li\n")) << "as ps and killall have it";
  const nlohmann::json summary = readJson(map + "/summary.json");
  EXPECT_EQ(summary["finished"], true);
  EXPECT_EQ(summary["frame_numbers"], nlohmann::json::array({0, 1, 2}));
  EXPECT_GT(summary["voxels"], 100);
  EXPECT_EQ(readKittiTrajectory(map + "/trajectory.txt").size(), 3u);
  EXPECT_TRUE(fs::exists(map + "/top_view.png"));
  EXPECT_FALSE(fs::exists(map + "/labels"));
}

TEST_F(LiveMap, GrowsWithTheFolderOfAnRgbdCamera)
{
  copyStreet(street);
  makeRgbd(street);
  const std::string colours = street + "/rgbd/rgb", kept = folder.path("kept");
  fs::rename(colours, kept);
  fs::create_directories(colours);
  std::string fill;
  for (const std::string frame : {"0", "1", "2"})
    fill += "cp " + kept + "/00000" + frame + ".png " + colours + "; " +
            waitFor("live: frame " + frame);
  const ToolResult result = runShell(
      start("--rgbd " + street + "/rgbd --calibration " + street + "/camera.yaml",
            street + "/labels", " --poses " + street + "/world.txt") +
      waitFor("waiting for the first pair of images in rgb and depth") + fill +
      "kill -INT $!; wait $!; code=$?; cat " + log + "; exit $code");
  EXPECT_EQ(result.code, 0) << result.text;
  EXPECT_TRUE(holds(result.text, "frames: 3"));
  EXPECT_EQ(readKittiTrajectory(map + "/trajectory.txt").size(), 3u);
  EXPECT_GT(readJson(map + "/summary.json")["voxels"], 100);
}

// Of a finger that was too quick; and the archive that goes with the map.
TEST_F(LiveMap, ASecondInterruptIsIgnored)
{
  const std::string archive = folder.path("live.map");
  const ToolResult twice =
      runShell(start(tinyStreet(), tinyStreet() + "/labels", " --archive " + archive) +
               waitFor("live: frame 2") +
               "kill -INT $!; sleep 0.02; kill -INT $!; wait $!; code=$?; cat " + log +
               "; exit $code");
  EXPECT_EQ(twice.code, 0) << twice.text;
  EXPECT_TRUE(holds(twice.text, "interrupted: the map is being finished"));
  EXPECT_EQ(readJson(map + "/summary.json")["finished"], true);
  EXPECT_TRUE(holds(succeed("archive info " + archive), "run: finished"));
  EXPECT_TRUE(holds(succeed("archive verify " + archive), "ok"));
}

TEST_F(LiveMap, InterruptedBeforeAnythingCameItWritesNothing)
{
  const ToolResult result =
      runShell("mkdir " + street + "; " + start(street) +
               waitFor("waiting for calib.txt") + "kill -INT $!; wait $!");
  EXPECT_EQ(result.code, 130) << result.text;
  EXPECT_FALSE(fs::exists(map));
}

TEST_F(LiveMap, WhatGoesWrongEndsItButNotWithoutTheMap)
{
  const std::string labels = folder.path("no_labels");
  const ToolResult result =
      runShell("mkdir " + labels + "; " + start(tinyStreet(), labels) +
               waitFor("live: frame 2") + "kill -INT $!; wait $!; code=$?; tail -n 1 " +
               log + "; exit $code");
  EXPECT_EQ(result.code, 3) << result.text;
  EXPECT_TRUE(holds(result.text, "no_labels"));
  EXPECT_EQ(readJson(map + "/summary.json")["finished"], false);
  EXPECT_EQ(readKittiTrajectory(map + "/trajectory.txt").size(), 3u);
  EXPECT_TRUE(fs::exists(map + "/map.pcd"));
}

TEST_F(LiveMap, RefusesWhatNeedsAllFramesAndIsNamedByOthers)
{
  const std::string output = " --output " + map, labels = tinyStreet() + "/labels",
                    live = "live " + tinyStreet() + " --labels " + labels + output,
                    videos = " --left " + folder.write("left.mp4", "") + " --right " +
                             folder.write("right.mp4", "") + " --calibration " +
                             tinyStreet() + "/calib.txt" + output;
  for (const auto& [command, code, says] :
       {std::tuple(
            "live --left 0 --right 2 --calibration c.yaml --labels l --times t.txt" +
                output,
            2, "--times needs --every-frame"),
        {live + " --network-every 2", 2, "--network-every needs --every-frame"},
        {live + " --poses sequence", 2, "--poses sequence"},
        {live + " --every-frame", 2, "--every-frame needs videos"},
        {"live --left 'l*.png' --right 'r*.png' --calibration c.yaml --labels l" +
             output,
         2, "expected cameras, streams or videos"},
        {"live " + street + " --labels " + labels + output, 3, "street: is no folder"},
        {"map --labels l" + videos, 2, "pcl_semantic_live --every-frame"},
        {"odometry" + videos, 2, "pcl_semantic_live --every-frame"},
        {"map " + tinyStreet() + " --labels l --live" + output, 2,
         "the program pcl_semantic_live"}})
    expectFails(command, code, says);
  EXPECT_FALSE(fs::exists(map));
}

} // namespace pcl_semantic
