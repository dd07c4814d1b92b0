// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_rigs.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/stereo_rig.h>

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <sstream>
#include <tuple>

namespace pcl_semantic {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// The reader refuses a text.
void
expectRefused(const std::string& says, const std::string& text)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("rig.yaml", text);
  const std::string message =
      thrownMessage<BadInputException>([&] { readStereoRig(path); });
  EXPECT_TRUE(holds(message, says));
  EXPECT_TRUE(holds(message, "rig.yaml"));
}

// Expects a refusal of a rig that is changed before it is written.
void
expectRefused(const std::string& says, const std::function<void(StereoRig&)>& change)
{
  const TemporaryFolder folder;
  StereoRig rig = exampleRig();
  change(rig);
  writeRig(folder.path("rig.yaml"), rig);
  expectRefused(says, bytesOf(folder.path("rig.yaml")));
}

void
expectSameRig(const StereoRig& read, const StereoRig& rig, double tolerance = 1e-12)
{
  EXPECT_EQ(read.width, rig.width);
  EXPECT_EQ(read.height, rig.height);
  EXPECT_TRUE(read.K1.isApprox(rig.K1, tolerance));
  EXPECT_TRUE(read.K2.isApprox(rig.K2, tolerance));
  EXPECT_EQ(read.D1, rig.D1);
  EXPECT_EQ(read.D2, rig.D2);
  EXPECT_TRUE(read.R.isApprox(rig.R, tolerance)) << read.R;
  EXPECT_TRUE(read.T.isApprox(rig.T, tolerance)) << read.T;
}

const std::string intrinsics = "K1: [500, 0, 320, 0, 501, 240, 0, 0, 1]\n"
                               "D1: [-0.1, 0.01, 0, 0]\n"
                               "K2: [502, 0, 321, 0, 503, 241, 0, 0, 1]\n"
                               "D2: [-0.2, 0.02, 0, 0, 0.001]\n";
const std::string extrinsics = "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.1, 0, 0]\n";

} // namespace

TEST(StereoRig, ReadsWhatOpenCvWrites)
{
  const TemporaryFolder folder;
  const StereoRig rig = exampleRig();
  for (const char* const name : {"rig.yaml", "rig.yml"}) {
    writeRig(folder.path(name), rig);
    expectSameRig(readStereoRig(folder.path(name)), rig, 1e-14);
  }
}

TEST(StereoRig, OpenCvsFileNamesItsFisheyes)
{
  const TemporaryFolder folder;
  const std::string four =
      intrinsics.substr(0, intrinsics.rfind(", 0.001")) + "]\n" + extrinsics;
  const auto read = [&](const std::string& line) {
    return readStereoRig(folder.write("rig.yaml", four + line)).is_fisheye;
  };
  EXPECT_FALSE(read(""));
  EXPECT_FALSE(read("fisheye_model: 0\n"));
  EXPECT_TRUE(read("fisheye_model: 1\n"));
  EXPECT_TRUE(read("distortion_model: equidistant\n"));
  expectBadInput("distortion_model is 'ds'", [&] { read("distortion_model: ds\n"); });
  expectBadInput("D2: has 5 numbers, expected the 4 of an equidistant fisheye", [&] {
    readStereoRig(folder.write("rig.yaml", intrinsics + extrinsics +
                                               "distortion_model: equidistant\n"));
  });
}

TEST(StereoRig, ReadsTheTwoFilesOfOpenCvsSample)
{
  const TemporaryFolder folder;
  StereoRig rig = exampleRig();
  const auto matrix = [](const auto& values) {
    cv::Mat result;
    cv::eigen2cv(values, result);
    return result;
  };
  const cv::Mat K1 = matrix(rig.K1), K2 = matrix(rig.K2), R = matrix(rig.R),
                T = matrix(rig.T);
  const std::string in = folder.path("intrinsics.yml"),
                    ex = folder.path("extrinsics.yml");
  {
    cv::FileStorage first(in, cv::FileStorage::WRITE);
    first << "M1" << K1 << "D1" << cv::Mat(rig.D1).t() << "M2" << K2 << "D2"
          << cv::Mat(rig.D2).t();
    cv::FileStorage second(ex, cv::FileStorage::WRITE);
    second << "R" << R << "T" << T << "R1" << R << "P1" << K1 << "Q" << K2;
  }
  rig.width = rig.height = 0; // they do not say
  expectSameRig(readStereoRig(in, ex), rig, 1e-14);
  expectBadInput("intrinsics.yml: key 'R' is missing", [&] { readStereoRig(in); });
}

TEST(StereoRig, OtherSpellings)
{
  const TemporaryFolder folder;
  const StereoRig read = readStereoRig(folder.write(
      "rig.yaml", "cameraMatrix1: [500, 0, 320, 0, 501, 240, 0, 0, 1]\ndist_coeffs_1: "
                  "[0, 0, 0, 0]\n"
                  "camera_matrix_2: [500, 0, 320, 0, 501, 240, 0, 0, 1]\n"
                  "distCoeffs2: !!opencv-matrix\n  rows: 1\n  cols: 4\n  dt: f\n"
                  "  data: [ 1.e-01, -2., 0., .5 ]\n"
                  "imageSize: [ 640, 480 ]\nrms: 0.21\n" +
                      extrinsics));
  EXPECT_EQ(read.width, 640);
  EXPECT_EQ(read.height, 480);
  EXPECT_EQ(read.D2, (std::vector<double>{0.1, -2.0, 0.0, 0.5}));
  EXPECT_EQ(read.K1(1, 1), 501.0);
}

TEST(StereoRig, ReadsTheExampleOfTheDocument)
{
  const std::string text = bytesOf(PCL_SEMANTIC_SOURCE_DIR "/doc/stereo.md");
  const std::string begin = "```yaml\n";
  const std::size_t at = text.find(begin) + begin.size();
  const TemporaryFolder folder;
  const StereoRig read = readStereoRig(
      folder.write("stereo.yaml", text.substr(at, text.find("```", at) - at)));
  EXPECT_EQ(read.width, 1280);
  EXPECT_EQ(read.height, 720);
  EXPECT_NEAR(read.T.norm(), 0.12, 1e-3);
}

TEST(StereoRig, RefusesValuesThatCannotBe)
{
  using Change = std::function<void(StereoRig&)>;
  for (const auto& [says, change] : std::vector<std::pair<std::string, Change>>{
           {"K1: focal lengths are 0 and 522 px", [](auto& r) { r.K1(0, 0) = 0.0; }},
           {"K2: is no camera matrix", [](auto& r) { r.K2(0, 1) = 3.0; }},
           {"K2: is no camera matrix", [](auto& r) { r.K2(2, 2) = 2.0; }},
           {"K2: '.Nan' is not a number", [](auto& r) { r.K2(1, 2) = nan; }},
           {"K1: the principal point (640, 237.3) is outside the images",
            [](auto& r) { r.K1(0, 2) = 640.0; }},
           {"D1: has 3 numbers, expected 4, 5, 8, 12 or 14",
            [](auto& r) { r.D1.resize(3); }},
           {"D2: '-.Inf' is not a number", [](auto& r) { r.D2[1] = -1.0 / 0.0; }},
           {"R: is no rotation", [](auto& r) { r.R *= 1.1; }},
           {"R: is no rotation (determinant -1", [](auto& r) { r.R *= -1.0; }},
           {"R: '.Nan' is not a number", [](auto& r) { r.R(1, 1) = nan; }}})
    expectRefused(says, change);
}

TEST(StereoRig, RefusesCamerasThatAreNotSideBySide)
{
  for (const auto& [x, y, z, says] :
       std::vector<std::tuple<double, double, double, std::string>>{
           {0, 0, 0, "T: is (0, 0, 0): the baseline is 0 m"},
           {nan, 0, 0, "T: '.Nan' is not a number"},
           {0.12, 0, 0, "the right camera is on the left, expected T.x"},
           {-0.01, 0.1, 0, "one camera is above the other"},
           {-0.01, 0, 0.1, "one camera is ahead of the other"},
           {-50, 0, 0, "if these are millimetres, expected metres"},
           {-120, 0, 0, "if these are millimetres, expected metres"}}) {
    const Eigen::Vector3d T(x, y, z);
    expectRefused(says, [&](StereoRig& rig) { rig.T = T; });
  }
}

TEST(StereoRig, MakesARotationOfOneWithFewDigits)
{
  const TemporaryFolder folder;
  StereoRig rig = exampleRig();
  const Eigen::Matrix3d exact = rig.R;
  rig.R = (1000.0 * rig.R).array().round() / 1000.0;
  ASSERT_GT((rig.R * rig.R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-4);
  writeRig(folder.path("rig.yaml"), rig);
  const StereoRig read = readStereoRig(folder.path("rig.yaml"));
  EXPECT_NO_THROW(read.validate());
  EXPECT_THROW(rig.validate(), InvalidParameterException);
  EXPECT_TRUE(read.R.isApprox(exact, 1e-3));
}

TEST(StereoRig, RefusesFilesThatHoldNone)
{
  const std::string cameras = intrinsics + extrinsics, T = "T: [-0.1, 0, 0]\n";
  for (const auto& [says, text] : std::vector<std::pair<std::string, std::string>>{
           {"", ""},
           {"", "- 1\n"},
           {"rig.yaml: is XML", "<?xml version=\"1.0\"?>\n"},
           {"'K1' or 'M1' or", extrinsics},
           {"key 'T' is missing", intrinsics + "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"},
           {"rig.yaml line 7: 'M2' repeats 'K2'", cameras + "M2: [1]\n"},
           {"rig.yaml line 5: R: has 3 numbers, expected 9",
            intrinsics + "R: [1, 0, 0]\n" + T},
           {"rig.yaml line 6: the value of 'R'", intrinsics + T + "R: one\n"},
           {"rig.yaml line 5: R: has 2 numbers, expected 3 x 3",
            intrinsics +
                "R: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n  data: [1, 0]\n" +
                T},
           {"expected both 'image_width' and 'image_height'",
            cameras + "image_width: 640\n"},
           {"image_size: has 1 numbers", cameras + "image_size: [640]\n"},
           {"the image size is -4 x 480", cameras + "image_size: [-4, 480]\n"}})
    expectRefused(says, text);
}

namespace {

// Numbers with commas between, row after row.
template <typename Matrix>
std::string
listOf(const Matrix& matrix)
{
  std::ostringstream text;
  text << matrix.format(
      Eigen::IOFormat(17, Eigen::DontAlignCols, ", ", ", ", "", "", "[", "]"));
  return text.str();
}

std::string
listOf(const std::vector<double>& values)
{
  return listOf(
      Eigen::Map<const Eigen::RowVectorXd>(values.data(), Eigen::Index(values.size())));
}

StereoRig
rigOfFourCoefficients()
{
  StereoRig rig = exampleRig();
  rig.D1.resize(4);
  rig.D2.resize(4);
  return rig;
}

std::string
camchain(const StereoRig& rig, const std::string& model = "radtan")
{
  const auto camera = [&](const Eigen::Matrix3d& K, const std::vector<double>& D) {
    return "  camera_model: pinhole\n  distortion_model: " + model +
           "\n  intrinsics: " +
           listOf(Eigen::RowVector4d(K(0, 0), K(1, 1), K(0, 2), K(1, 2))) +
           "\n  distortion_coeffs: " + listOf(D) + "\n  resolution: [640, 480]\n";
  };
  std::string text = "cam0:\n" + camera(rig.K1, rig.D1) + "  rostopic: /left\ncam1:\n" +
                     camera(rig.K2, rig.D2) + "  T_cn_cnm1:\n";
  for (int i = 0; i < 3; ++i) {
    Eigen::RowVector4d row;
    row << rig.R.row(i), rig.T[i];
    text += "  - " + listOf(row) + "\n";
  }
  return text + "  - [0.0, 0.0, 0.0, 1.0]\n";
}

// camera_info as camera_calibration writes it.
std::string
cameraInfo(const Eigen::Matrix3d& K, const std::vector<double>& D,
           const Eigen::Matrix3d& rectification, double Tx)
{
  const auto matrix = [](const char* name, int rows, int columns,
                         const std::string& data) {
    return std::string(name) + ":\n  rows: " + std::to_string(rows) +
           "\n  cols: " + std::to_string(columns) + "\n  data: " + data + "\n";
  };
  Eigen::Matrix<double, 3, 4> P;
  P << 450, 0, 320, Tx, 0, 450, 238, 0, 0, 0, 1, 0;
  return "image_width: 640\nimage_height: 480\ncamera_name: left\n" +
         matrix("camera_matrix", 3, 3, listOf(K)) + "distortion_model: plumb_bob\n" +
         matrix("distortion_coefficients", 1, int(D.size()), listOf(D)) +
         matrix("rectification_matrix", 3, 3, listOf(rectification)) +
         matrix("projection_matrix", 3, 4, listOf(P));
}

} // namespace

TEST(StereoRig, ReadsKalibrsCamchain)
{
  const TemporaryFolder folder;
  const StereoRig rig = rigOfFourCoefficients();
  expectSameRig(readStereoRig(folder.write("camchain.yaml", camchain(rig))), rig);
  const StereoRig fisheyes =
      readStereoRig(folder.write("fisheyes.yaml", camchain(rig, "equidistant")));
  expectSameRig(fisheyes, rig);
  EXPECT_TRUE(fisheyes.is_fisheye);
  const std::string text = camchain(rig);
  for (const auto& [says, bad] : std::vector<std::pair<std::string, std::string>>{
           {"distortion_model is 'fov', expected 'radtan'", camchain(rig, "fov")},
           {"has one camera, expected cam0 and cam1",
            text.substr(0, text.find("cam1:"))},
           {"T_cn_cnm1: is no 4 x 4 matrix", text.substr(0, text.rfind("  - "))},
           {"T_cn_cnm1", text.substr(0, text.find("  T_cn"))}})
    expectRefused(says, bad);
}

TEST(StereoRig, ReadsTheCameraInfosOfRos)
{
  const TemporaryFolder folder;
  const StereoRig rig = exampleRig();
  const Eigen::Matrix3d A1 = rotationBy(1.0, -1.5, 0.7),
                        A2 = rotationBy(-0.8, 1.2, -0.5);
  const std::string left =
      folder.write("left.yaml", cameraInfo(rig.K1, rig.D1, A1.transpose(), 0.0));
  const std::string right = folder.write(
      "right.yaml", cameraInfo(rig.K2, rig.D2, A2.transpose(), -450.0 * 0.12));
  expectSameRig(readStereoRig(left, right), rig);
  const std::vector<double> four(rig.D1.begin(), rig.D1.begin() + 4);
  std::string text = cameraInfo(rig.K1, four, A1.transpose(), 0.0);
  text.replace(text.find("plumb_bob"), 9, "equidistant");
  const std::string fisheye = folder.write("fisheye.yaml", text);
  for (const auto& [first, second, says] : std::vector<std::array<std::string, 3>>{
           {left, "",
            "left.yaml: is the camera_info of one camera; give that of the right one"},
           {right, left, "are left and right swapped?"},
           {left, left, "the baseline is 0 m"},
           {fisheye, right, "one camera is a fisheye"}})
    expectBadInput(says,
                   [&, &one = first, &other = second] { readStereoRig(one, other); });
}

} // namespace pcl_semantic
