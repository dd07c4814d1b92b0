// SPDX-License-Identifier: BSD-3-Clause
#include "support/same_image.h"
#include "support/stereo_rigs.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/dataset/image_pair_sequence.h>
#include <pcl_semantic/dataset/sequence_files.h>
#include <pcl_semantic/dataset/stereo_rig.h>
#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>

#include <filesystem>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Images of one grey value each, and exampleRig() as their calibration.
struct Pairs {
  TemporaryFolder folder;
  ImagePairFiles files;

  Pairs()
  {
    fs::create_directories(folder.path("left"));
    fs::create_directories(folder.path("right"));
    files.left = folder.path("left") + "/*.png";
    files.right = folder.path("right") + "/*.png";
    files.calibration = folder.path("stereo.yaml");
    writeRig(files.calibration, exampleRig());
  }

  void
  add(const std::string& name, int grey, cv::Size size = {640, 480},
      int type = CV_8UC3) const
  {
    writePng(folder.path(name), cv::Mat(size, type, cv::Scalar::all(grey)));
  }

  void
  expectRefused(const std::string& says) const
  {
    expectBadInput(says, [&] { ImagePairSequence{files}; });
  }
};

} // namespace

TEST(ImagePairSequence, PairsInNaturalOrder)
{
  Pairs pairs;
  for (const int n : {2, 10, 1}) {
    pairs.add("left/img" + std::to_string(n) + "_cam0.png", n);
    pairs.add("right/img" + std::to_string(n) + "_cam1.png", 100 + n);
  }
  const ImagePairSequence sequence(pairs.files);
  ASSERT_EQ(sequence.size(), 3u);
  const int order[] = {1, 2, 10};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(sequence.frameNumber(i), int(i));
    const StereoFrame frame = sequence.frame(i);
    EXPECT_EQ(frame.number, int(i));
    EXPECT_DOUBLE_EQ(frame.timestamp, 0.1 * double(i));
    EXPECT_EQ(frame.left.at<cv::Vec3b>(240, 320),
              cv::Vec3b::all(std::uint8_t(order[i])));
    EXPECT_EQ(frame.right.at<cv::Vec3b>(240, 320),
              cv::Vec3b::all(std::uint8_t(100 + order[i])));
  }
  EXPECT_EQ(sequence.posesPath(), "");
}

TEST(ImagePairSequence, RectifiesAndKnowsHowTheCameraWasTurned)
{
  Pairs pairs;
  cv::Mat1b left(480, 640), right(480, 640);
  cv::randu(left, 0, 256);
  cv::randu(right, 0, 256);
  writePng(pairs.folder.path("left/0.png"), left);
  writePng(pairs.folder.path("right/0.png"), right);
  const ImagePairSequence sequence(pairs.files);
  const Rectifier rectifier(readStereoRig(pairs.files.calibration));
  EXPECT_DOUBLE_EQ(sequence.camera().fx, rectifier.camera().fx);
  EXPECT_DOUBLE_EQ(sequence.camera().baseline, rectifier.camera().baseline);
  EXPECT_TRUE(
      sequence.T_camera0_camera().isApprox(rectifier.T_left_rectified(), 1e-12));
  EXPECT_FALSE(sequence.T_camera0_camera().matrix().isIdentity(1e-3));
  const StereoFrame frame = sequence.frame(0);
  EXPECT_TRUE(isSameImage(frame.left, rectifier.rectify(left, StereoSide::left)));
  EXPECT_TRUE(isSameImage(frame.right, rectifier.rectify(right, StereoSide::right)));
  EXPECT_GT(cv::norm(frame.left, left, cv::NORM_L1), 1e5);
}

TEST(ImagePairSequence, TimesByRow)
{
  Pairs pairs;
  for (const char* const name :
       {"left/a.png", "left/b.png", "right/a.png", "right/b.png"})
    pairs.add(name, 1);
  pairs.files.times = pairs.folder.write("times.txt", "7.5\n7.75\n8\n");
  const ImagePairSequence sequence(pairs.files);
  EXPECT_EQ(sequence.frame(0).timestamp, 7.5);
  EXPECT_EQ(sequence.frame(1).timestamp, 7.75);
  pairs.folder.write("times.txt", "7.5\n");
  pairs.expectRefused("times.txt: has 1 times for 2 pairs");
}

TEST(ImagePairSequence, RefusesWhatAreNoPairs)
{
  Pairs pairs;
  pairs.expectRefused("left/*.png: no file matches");
  for (const char* const name : {"left/l1.png", "left/l2.png", "left/l3.png"})
    pairs.add(name, 1);
  pairs.expectRefused("right/*.png: no file matches");
  pairs.add("right/r1.png", 1);
  pairs.add("right/r2.png", 1);
  pairs.expectRefused("left/*.png: matches 3 files, but ");
  pairs.expectRefused("right/*.png matches 2");
  fs::remove(pairs.folder.path("right/r2.png"));
  pairs.add("right/r3.png", 1);
  pairs.add("right/r4.png", 1);
  pairs.expectRefused("left/l2.png and ");
  pairs.expectRefused("right/r3.png: have different numbers");
  pairs.files.right = pairs.files.left;
  pairs.expectRefused("l1.png: is both the left and the right image");
}

TEST(ImagePairSequence, RefusesImagesOfAnotherSizeAndACalibrationOfNothing)
{
  Pairs pairs;
  pairs.add("left/1.png", 1, {320, 240});
  pairs.add("right/1.png", 1, {320, 240});
  pairs.expectRefused("left/1.png: has 320 x 240 pixels, but ");
  pairs.expectRefused("stereo.yaml is the calibration of 640 x 480");
  // Without a size in the file the principal point tells.
  StereoRig rig = exampleRig();
  rig.width = rig.height = 0;
  std::string text = bytesOf(pairs.files.calibration);
  text = text.substr(text.find("K1:"));
  pairs.folder.write("stereo.yaml", text);
  pairs.expectRefused("stereo.yaml: K1: the principal point");

  pairs.add("left/1.png", 1);
  pairs.add("right/1.png", 1);
  rig = exampleRig();
  rig.D2[0] = -40.0;
  writeRig(pairs.files.calibration, rig);
  pairs.expectRefused("right image can be rectified; check K, D");
}

TEST(EurocFolder, IsOpenedAsItComes)
{
  const TemporaryFolder folder;
  for (const std::string camera : {"cam0", "cam1"}) {
    fs::create_directories(folder.path("v1/mav0/" + camera + "/data"));
    const std::string x = camera == "cam0" ? "-0.02" : "0.09";
    folder.write("v1/mav0/" + camera + "/sensor.yaml",
                 "sensor_type: camera\ncomment: VI-Sensor\n"
                 "T_BS:\n  cols: 4\n  rows: 4\n"
                 "  data: [1, 0, 0, " +
                     x +
                     ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n"
                     "rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\n"
                     "intrinsics: [458.6, 457.2, 367.2, 248.3]\n"
                     "distortion_model: radial-tangential\n"
                     "distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]\n");
    for (const std::string name : {"1403636579763555584", "1403636579813555456"})
      writePng(folder.path("v1/mav0/" + camera + "/data/" + name + ".png"),
               cv::Mat(480, 752, CV_8UC1, cv::Scalar(90)));
  }
  for (const char* const name : {"v1", "v1/mav0"}) {
    SequenceFiles files;
    files.folder = folder.path(name);
    std::vector<std::string> doubts;
    const auto sequence = openSequence(files, doubts);
    ASSERT_EQ(sequence->size(), 2u);
    EXPECT_NEAR(sequence->camera().baseline, 0.11, 1e-9);
    EXPECT_NEAR(sequence->timestamp(0), 1403636579.763555584, 1e-6);
    EXPECT_NEAR(sequence->frame(1).timestamp - sequence->timestamp(0), 0.05, 1e-6);
    EXPECT_TRUE(sequence->posesPath().empty());
  }
}

// Two cameras' images in folders, the calibration two folders above.
TEST(OtherFolders, OfKitti360AndEth3dAreOpenedAsTheyCome)
{
  const TemporaryFolder folder;
  fs::create_directories(folder.path("calibration"));
  folder.write("calibration/perspective.txt",
               "calib_time: 25-May-2019\nS_rect_00: 1408 376\n"
               "P_rect_00: 552.5 0 682 0 0 552.5 238.8 0 0 0 1 0\n"
               "S_rect_01: 1408 376\n"
               "P_rect_01: 552.5 0 682 -328.3 0 552.5 238.8 0 0 0 1 0\n");
  for (const std::string side : {"image_00", "image_01"}) {
    const std::string images = folder.path("data_2d_raw/drive_0000_sync/" + side);
    fs::create_directories(images + "/data_rect");
    for (const std::string name : {"0000000250.png", "0000000251.png"})
      writePng(images + "/data_rect/" + name,
               cv::Mat(376, 1408, CV_8UC3, cv::Scalar::all(9)));
  }
  fs::create_directories(folder.path("delivery_area_1l"));
  folder.write("delivery_area_1l/calib.txt",
               "cam0=[541.7 0 553.8; 0 541.7 232.4; 0 0 1]\n"
               "cam1=[541.7 0 553.8; 0 541.7 232.4; 0 0 1]\n"
               "doffs=0\nbaseline=59.98\nwidth=942\nheight=489\nndisp=70\n");
  for (const std::string name : {"im0.png", "im1.png"})
    writePng(folder.path("delivery_area_1l/" + name),
             cv::Mat(489, 942, CV_8UC1, cv::Scalar(9)));
  for (const auto& [name, frames, baseline] :
       {std::tuple("data_2d_raw/drive_0000_sync", 2u, 328.3 / 552.5),
        std::tuple("delivery_area_1l", 1u, 0.05998)}) {
    SequenceFiles files;
    files.folder = folder.path(name);
    std::vector<std::string> doubts;
    const auto sequence = openSequence(files, doubts);
    EXPECT_EQ(sequence->size(), frames);
    EXPECT_NEAR(sequence->camera().baseline, baseline, 1e-9);
    EXPECT_EQ(sequence->frame(0).left.cols, sequence->camera().width);
  }
}

} // namespace pcl_semantic
