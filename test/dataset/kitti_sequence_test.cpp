// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <map>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

const std::map<std::string, std::string> rows{
    {"P0", "500 0 60 0 0 400 40 0 0 0 1 0"},
    {"P1", "500 0 60 -100 0 400 40 0 0 0 1 0"},
    {"P2", "500 0 60 30.6 0 400 40 4.4 0 0 1 0.01"},
    {"P3", "500 0 60 -220 0 400 40 4.4 0 0 1 0"},
    {"Tr", "0 -1 0 0.1 0 0 -1 -0.2 1 0 0 -0.3"},
};

/** \brief calib.txt with some rows replaced; an empty one is left out. */
std::string
calibration(const std::map<std::string, std::string>& other = {},
            const std::string& end_of_line = "\n")
{
  std::string text;
  for (const auto& [name, numbers] : rows) {
    const auto replaced = other.find(name);
    const std::string& row = replaced == other.end() ? numbers : replaced->second;
    if (!row.empty())
      text += name + ": " + row + end_of_line;
  }
  return text;
}

void
writeFrames(const TemporaryFolder& folder, const std::string& name,
            const std::vector<int>& frames, int type = CV_8UC3)
{
  fs::create_directories(folder.path(name));
  for (const int frame : frames)
    writePng(folder.path(name) + "/" + frameFileName(frame, ".png"),
             cv::Mat(80, 120, type, cv::Scalar::all(frame)));
}

void
writeSequence(const TemporaryFolder& folder, const std::vector<int>& frames)
{
  writeFrames(folder, "image_2", frames);
  writeFrames(folder, "image_3", frames);
  folder.write("calib.txt", calibration());
}

// EXPECTs that the sequence cannot be opened.
void
expectRefused(const std::string& says, const std::string& folder)
{
  expectBadInput(says, [&] { KittiSequence{folder}; });
}

} // namespace

TEST(KittiCalibration, GeometryOfBothPairs)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("calib.txt", calibration());
  const KittiCalibration grey = readKittiCalibration(path, KittiCameras::grey);
  EXPECT_DOUBLE_EQ(grey.camera.baseline, 0.2);
  EXPECT_TRUE(grey.T_camera0_camera.matrix().isIdentity());

  const KittiCalibration colour = readKittiCalibration(path, KittiCameras::colour);
  EXPECT_DOUBLE_EQ(colour.camera.fx, 500.0);
  EXPECT_DOUBLE_EQ(colour.camera.fy, 400.0);
  EXPECT_DOUBLE_EQ(colour.camera.cx, 60.0);
  EXPECT_DOUBLE_EQ(colour.camera.cy, 40.0);
  // t2 = ((30.6 - 60 * 0.01) / 500, (4.4 - 40 * 0.01) / 400, 0.01), t3.x = -220 / 500
  EXPECT_NEAR(colour.camera.baseline, 0.06 + 0.44, 1e-12);

  // P2 projects a point of camera 0, and the camera the same point of its own frame, to
  // the same pixel.
  Eigen::Matrix<double, 3, 4> P2;
  P2 << 500, 0, 60, 30.6, 0, 400, 40, 4.4, 0, 0, 1, 0.01;
  const Eigen::Vector3d point(1.0, -0.5, 7.0);
  const Eigen::Vector3d pixel = P2 * point.homogeneous();
  const Eigen::Vector2d own =
      colour.camera.project(colour.T_camera0_camera.inverse() * point);
  EXPECT_NEAR(own.x(), pixel.x() / pixel.z(), 1e-9);
  EXPECT_NEAR(own.y(), pixel.y() / pixel.z(), 1e-9);

  // A point ahead of the scanner (x forward, z up) is ahead of the camera.
  ASSERT_TRUE(colour.T_camera0_velodyne.has_value());
  const Eigen::Vector3d ahead = *colour.T_camera0_velodyne * Eigen::Vector3d(10, 2, 1);
  EXPECT_TRUE(ahead.isApprox(Eigen::Vector3d(-1.9, -1.2, 9.7)));
  // Windows' text and other rows are accepted.
  const KittiCalibration result = readKittiCalibration(
      folder.write("calib.txt", "\xEF\xBB\xBF" + calibration({{"Tr", ""}}, "  \r\n") +
                                    "\r\nS_02: 1 2\r\n"),
      KittiCameras::colour);
  EXPECT_DOUBLE_EQ(result.camera.fx, 500.0);
  EXPECT_FALSE(result.T_camera0_velodyne.has_value());
}

TEST(KittiCalibration, RefusesWithTheLine)
{
  const std::string good = "500 0 60 1 0 400 40 0 0 0 1 ";
  const TemporaryFolder folder;
  const auto expectBad = [&](const std::string& says, const std::string& text) {
    const std::string path = folder.write("calib.txt", text);
    expectBadInput(says, [&] { readKittiCalibration(path, KittiCameras::colour); });
  };
  for (const auto& [name, row, says] : std::vector<std::array<std::string, 3>>{
           {"P1", good, "calib.txt line 2: P1: has 11 numbers, expected 12"},
           {"P2", good + "nan", "calib.txt line 3: P2: 'nan'"},
           {"P2", good + "1,5", "'1,5'"},
           {"P2", "-500 0 60 1 0 400 40 0 0 0 1 0",
            "line 3: P2: focal lengths are -500"},
           {"P2", "500 3 60 1 0 400 40 0 0 0 1 0", "line 3: P2: the left 3 x 3 block"},
           {"P3", "500 0 61 -220 0 400 40 0 0 0 1 0",
            "line 4: P3: the camera matrix differs"},
           {"P3", "500 0 60 220 0 400 40 0 0 0 1 0", "line 4: P3: baseline is -"},
           {"P3", "", "has no row 'P3:'"},
           {"Tr", "0 1 0 0 0 0 -1 0 1 0 0 0",
            "line 5: Tr: the left 3 x 3 block is no rotation"}})
    expectBad(says, calibration({{name, row}}));
  expectBad("is there twice", calibration() + "P2: " + good + "0\n");
}

TEST(KittiSequence, GapsAndTimesByFrameNumber)
{
  const TemporaryFolder folder;
  writeSequence(folder, {3, 10});
  std::string times;
  for (int row = 0; row < 12; ++row)
    times += std::to_string(row * row) + "\n";
  folder.write("times.txt", times);
  const KittiSequence sequence(folder.path());
  ASSERT_EQ(sequence.size(), 2u);
  EXPECT_EQ(sequence.frameNumber(0), 3);
  EXPECT_EQ(sequence.frameNumber(1), 10);
  const StereoFrame frame = sequence.frame(1);
  EXPECT_EQ(frame.number, 10);
  EXPECT_EQ(frame.timestamp, 100.0);
  EXPECT_EQ(frame.left.at<cv::Vec3b>(5, 5), cv::Vec3b(10, 10, 10));
  EXPECT_EQ(frame.right.type(), CV_8UC3);
  EXPECT_EQ(sequence.camera().width, 120);
  EXPECT_EQ(sequence.camera().height, 80);
  EXPECT_EQ(sequence.posesPath(), "");
  EXPECT_TRUE(sequence.hasVelodyne());
  fs::remove(folder.path("times.txt")); // ten frames a second
  EXPECT_DOUBLE_EQ(KittiSequence(folder.path()).frame(0).timestamp, 0.3);
}

TEST(KittiSequence, ChoosesCameras)
{
  const TemporaryFolder folder;
  writeFrames(folder, "image_0", {0}, CV_8UC1);
  writeFrames(folder, "image_1", {0}, CV_8UC1);
  folder.write("calib.txt", calibration());
  const KittiSequence grey(folder.path());
  EXPECT_DOUBLE_EQ(grey.camera().baseline, 0.2);
  EXPECT_EQ(grey.frame(0).left.type(), CV_8UC1);
  expectBadInput("image_2",
                 [&] { KittiSequence(folder.path(), KittiCameras::colour); });
  writeFrames(folder, "image_2", {0});
  writeFrames(folder, "image_3", {0});
  EXPECT_NEAR(KittiSequence(folder.path()).camera().baseline, 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(KittiSequence(folder.path(), KittiCameras::grey).camera().baseline,
                   0.2);
}

TEST(KittiSequence, RefusesMissingPartners)
{
  const TemporaryFolder folder;
  writeSequence(folder, {0, 1, 2, 7});
  fs::remove(folder.path("image_3/000001.png"));
  expectRefused("image_3/000001.png: is missing", folder.path());
  fs::remove(folder.path("image_2/000001.png"));
  EXPECT_EQ(KittiSequence(folder.path()).size(), 3u);
  fs::remove(folder.path("image_2/000007.png"));
  expectRefused("image_2/000007.png: is missing", folder.path());
  fs::remove_all(folder.path("image_2"));
  fs::create_directories(folder.path("image_2"));
  expectRefused("holds no images", folder.path());
  expectRefused("is no folder", folder.path("nothing"));
}

TEST(KittiSequence, RefusesBadTimes)
{
  const TemporaryFolder folder;
  writeSequence(folder, {0, 2});
  for (const auto& [times, says] : std::vector<std::pair<std::string, std::string>>{
           {"0\n0.1\n", "times.txt: has 2 times, but frame 2"},
           {"0\n0.1 0.2\n0.3\n\n", "times.txt line 2"},
           {"0\n\n0.3\n", "times.txt line 2"}, // would shift the rows
           {"0\n0.1\ninf\n", "times.txt line 3"}}) {
    folder.write("times.txt", times);
    expectRefused(says, folder.path());
  }
}

TEST(KittiSequence, RefusesBadImages)
{
  const TemporaryFolder folder;
  writeSequence(folder, {0, 1, 2, 3});
  writePng(folder.path("image_3/000001.png"),
           cv::Mat(80, 121, CV_8UC3, cv::Scalar::all(0)));
  writePng(folder.path("image_3/000002.png"),
           cv::Mat(80, 120, CV_8UC1, cv::Scalar::all(0)));
  folder.write("image_2/000003.png", "no image");
  const KittiSequence sequence(folder.path());
  EXPECT_NO_THROW(sequence.frame(0));
  for (const char* const says :
       {"image_3/000001.png: has 121 x 80 pixels, expected 120 x 80", "frame 1"})
    expectBadInput(says, [&] { sequence.frame(1); });
  expectBadInput("has 1 channel(s)", [&] { sequence.frame(2); });
  expectBadInput("is not a PNG image (frame 3)", [&] { sequence.frame(3); });
}

TEST(KittiSequence, RealRecordings)
{
  const char* data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "skipped: PCL_SEMANTIC_DATA is not set";
  const KittiSequence fifteen(std::string(data) + "/kitti/15");
  EXPECT_EQ(fifteen.size(), 4u);
  EXPECT_EQ(fifteen.camera().width, 1241);
  EXPECT_EQ(fifteen.camera().height, 376);
  EXPECT_EQ(fifteen.frame(3).left.type(), CV_8UC3);

  const KittiSequence five(std::string(data) + "/kitti/05");
  EXPECT_EQ(five.size(), 10u);
  EXPECT_EQ(five.frameNumber(9), 9);
  EXPECT_NEAR(five.frame(1).timestamp, 0.1042283, 1e-9);
  EXPECT_NEAR(five.camera().baseline, 0.5355, 1e-3);
  // The colour camera is 6 cm left of camera 0.
  EXPECT_NEAR(five.T_camera0_camera().translation().x(), -0.061, 1e-3);
  EXPECT_EQ(readKittiTrajectory(five.posesPath()).size(), 2761u);
  // The scanner is above (y down) and behind camera 0.
  EXPECT_LT(five.T_camera0_velodyne().translation().y(), 0.0);

  const KittiSequence six(std::string(data) + "/kitti_gray/06");
  EXPECT_EQ(six.size(), 51u);
  EXPECT_EQ(six.frame(50).left.type(), CV_8UC1);
  EXPECT_EQ(six.camera().width, 1226);
  EXPECT_TRUE(six.T_camera0_camera().matrix().isIdentity());
  EXPECT_DOUBLE_EQ(six.frame(50).timestamp, 5.0);
}

} // namespace pcl_semantic
