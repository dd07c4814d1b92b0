// SPDX-License-Identifier: BSD-3-Clause
#include "files/pcd_file.h"
#include "support/bad_case.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <opencv2/core.hpp>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace pcl_semantic {

namespace {

const std::string one_pair = "stereo STREET/image_2/000000.png "
                             "STREET/image_3/000000.png STREET/calib.txt ";

void
swapSides(const std::string& street)
{
  std::filesystem::rename(street + "/image_2", street + "/other");
  std::filesystem::rename(street + "/image_3", street + "/image_2");
  std::filesystem::rename(street + "/other", street + "/image_3");
}

std::string
inStreet(const std::string& command)
{
  return replaceAll(command, "STREET", tinyStreet());
}

} // namespace

TEST(StereoTool, OnePairIsTheCloudOfTheLibrary)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("pair.pcd"), picture = folder.path("d.png");
  const KittiSequence sequence(tinyStreet());
  const StereoFrame frame = sequence.frame(0);
  for (const std::string& engine : disparityEngines()) {
    succeed(inStreet(one_pair) + path + " --disparity " + picture + " --stereo " +
            engine + " --disparities 64 --max-depth 0 --max-deviation 0");
    const cv::Mat disparity =
        makeDisparityEstimator(engine, 64)->estimate(frame.left, frame.right).disparity;
    const auto expected = disparityToCloud(disparity, frame.left, sequence.camera());
    const PcdTable table = readPcd(path);
    ASSERT_EQ(table.width, 208u);
    ASSERT_EQ(table.height, 64u);
    const PcdColumn x(table, table.find("x")), z(table, table.find("z"));
    for (std::size_t i = 0; i < table.points(); ++i) {
      const pcl::PointXYZRGB& point = (*expected)[i];
      EXPECT_TRUE(std::isnan(point.x) ? std::isnan(x(i)) && std::isnan(z(i))
                                      : x(i) == point.x && z(i) == point.z);
    }
    EXPECT_EQ(readPng(picture, ImageKind::grey_or_colour).size(), disparity.size());
  }
}

TEST(StereoTool, WhatIsFarOrUnsureHasNoDepth)
{
  const TemporaryFolder folder;
  const auto depths = [&](const std::string& options) {
    const std::string path = folder.path("pair.pcd");
    succeed(inStreet(one_pair) + path + " " + options);
    const PcdTable table = readPcd(path);
    const PcdColumn z(table, table.find("z"));
    std::vector<double> found;
    for (std::size_t i = 0; i < table.points(); ++i)
      if (std::isfinite(z(i)))
        found.push_back(z(i));
    return found;
  };
  const std::vector<double> all = depths("--max-depth 0 --max-deviation 0");
  const std::vector<double> matched = depths("--max-depth 0");
  const std::vector<double> near = depths("--max-depth 12");
  EXPECT_GT(all.size(), matched.size());
  EXPECT_GT(matched.size(), near.size());
  EXPECT_GT(near.size(), 500u);
  EXPECT_LE(*std::max_element(near.begin(), near.end()), 12.0);
}

TEST(StereoTool, AFolderAtATime)
{
  const TemporaryFolder folder;
  const std::string text =
      succeed(inStreet("stereo STREET/image_2 STREET/image_3 STREET/calib.txt ") +
              folder.path("clouds") + " --disparity " + folder.path("pictures"));
  EXPECT_TRUE(holds(text, "clouds: 3\nwidth: 208\nheight: 64\n"));
  for (const std::string name : {"000000", "000001", "000002"}) {
    EXPECT_EQ(readPcd(folder.path("clouds/" + name + ".pcd")).points(), 208u * 64u);
    EXPECT_TRUE(std::filesystem::exists(folder.path("pictures/" + name + ".png")));
  }
}

TEST(StereoTool, FilesOfAnEarlierRunAreTold)
{
  const TemporaryFolder folder;
  const std::string run =
      inStreet("stereo STREET/image_2 STREET/image_3 STREET/calib.txt ") +
      folder.path();
  EXPECT_FALSE(holds(runTool(run).text, "other"));
  EXPECT_FALSE(holds(runTool(run).text, "other"));
  folder.write("000007.pcd", "");
  EXPECT_TRUE(
      holds(runTool(run).text, "holds 1 other .pcd file, which this run keeps"));
  std::filesystem::create_directories(folder.path("street/image_2"));
  folder.write("street/image_2/000003.png", "");
  expectFails("synthesize --size 208x64 --frames 3 " + folder.path("street"), 2,
              "000003.png: is of a longer sequence");
}

TEST(StereoTool, AFolderOfAnotherLensIsRefused)
{
  const TemporaryFolder folder;
  const std::string run = "synthesize --size 64x32 --frames 1 ";
  for (const std::string scene : {"--scene street ", "--scene room "}) {
    const std::string out = folder.path(scene.substr(8, 4));
    succeed(run + scene + out);
    succeed(run + scene + out);
    expectFails(run + scene + "--lens fisheye " + out, 2, "is of another lens");
    succeed(run + scene + "--lens fisheye " + out + "_fisheye");
    succeed(run + scene + "--lens fisheye " + out + "_fisheye");
    expectFails(run + scene + out + "_fisheye", 2, "is of another lens");
  }
}

TEST(StereoTool, BracketsInPathsAreMeantAsTheyAre)
{
  const TemporaryFolder folder;
  const std::string street = folder.path("a [1] b");
  copyStreet(street);
  std::filesystem::copy_file(street + "/image_2/000001.png", street + "/q1.png");
  std::filesystem::copy_file(street + "/image_2/000000.png", street + "/q[1].png");
  const auto quoted = [&](const std::string& path) {
    return "'" + street + "/" + path + "' ";
  };
  const std::string rest = quoted("image_3/000000.png") + quoted("calib.txt");
  succeed("stereo " + quoted("q[1].png") + rest + folder.path("one.pcd"));
  succeed("stereo " + quoted("image_2/000000.png") + rest + folder.path("same.pcd"));
  EXPECT_TRUE(bytesOf(folder.path("one.pcd")) == bytesOf(folder.path("same.pcd")));
  succeed("stereo " + quoted("image_2") + quoted("image_3") + quoted("calib.txt") +
          folder.path("all"));
}

TEST(StereoTool, SwappedPairsAreWarnedOf)
{
  const TemporaryFolder folder;
  copyStreet(folder.path("street"));
  swapSides(folder.path("street"));
  const std::string labels = " --labels " + folder.path("street/labels");
  for (const std::string& command :
       {"stereo " + folder.path("street/image_2 ") + folder.path("street/image_3 ") +
            folder.path("street/calib.txt ") + folder.path("clouds"),
        "map " + folder.path("street") + labels + " --output " + folder.path("map"),
        "odometry " + folder.path("street ") + folder.path("poses.txt")}) {
    const ToolResult result = runTool(command);
    EXPECT_TRUE(holds(result.text, "left and right are swapped"));
    EXPECT_TRUE(holds(result.text, "warning: 3 pairs looked swapped"));
  }
}

TEST(StereoTool, BadPairs)
{
  const std::string folders = "stereo STREET/image_2 STREET/image_3 STREET/calib.txt ";
  expectAllFail(
      {{2, "expected LEFT RIGHT CALIBRATION OUT", "stereo"},
       {2, "ends in .pcd", one_pair + "TEMP/out.ply"},
       {2, "ends in .png", one_pair + "TEMP/out.pcd --disparity TEMP/d.jpg"},
       {2, "two images, or two folders",
        "stereo STREET/image_2 STREET/image_3/000000.png STREET/calib.txt OUT"},
       {3, "does not exist",
        "stereo 'STREET/image_2/*.png' 'STREET/image_3/*.png' STREET/calib.txt "
        "OUT"},
       {5, "cannot be made",
        "stereo STREET/image_2 STREET/image_3 STREET/calib.txt "
        "STREET/calib.txt/OUT"},
       {2, "--max-depth is nan", one_pair + "TEMP/out.pcd --max-depth nan"},
       {2, "holds images of frames",
        "map STREET --output STREET/image_2 --labels STREET/labels"},
       {2, "is the name of an image", "odometry STREET STREET/image_2/000001.png"},
       {3, "times.txt line 2: is not later", "odometry STREET TEMP/out.txt",
        [](const std::string& street) {
          std::ofstream(street + "/times.txt") << "0.5\n0.5\n0.6\n";
        }},
       {3, "left and right are swapped", folders + "OUT --strict", swapSides},
       {3, "frame 0: left and right are swapped", "--labels STREET/labels --strict",
        swapSides},
       {3, "frame 0: left and right are swapped",
        "odometry STREET TEMP/poses.txt --strict", swapSides},
       {3, "frame 1: ", "--labels STREET/labels --strict",
        [](const std::string& street) {
          writePng(street + "/image_3/000001.png",
                   cv::Mat(64, 208, CV_8UC3, cv::Scalar::all(3)));
        }}});
}

TEST(StereoTool, RectifiesFisheyesAndDoubtsAWrongLens)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "skipped: PCL_SEMANTIC_DATA is not set";
  const TemporaryFolder folder;
  const std::string fisheye = std::string(data) + "/fisheye/";
  std::ifstream file(fisheye + "camchain.yaml");
  const std::string camchain(std::istreambuf_iterator<char>(file), {});
  const auto run = [&](const std::string& model) {
    const std::string rig =
        folder.write("rig.yaml", replaceAll(camchain, "equidistant", model));
    return succeed("stereo " + fisheye + "left_fisheye_img_0.png " + fisheye +
                   "right_fisheye_img_0.png " + rig + " " + folder.path("out.pcd"));
  };
  const std::string good = run("equidistant");
  EXPECT_FALSE(holds(good, "warning"));
  const std::string key = "valid_fraction: ";
  EXPECT_GT(std::stod(good.substr(good.find(key) + key.size())), 0.75);
  EXPECT_TRUE(holds(run("radtan"), "rows between left and right: are the calibration"));
}

} // namespace pcl_semantic
