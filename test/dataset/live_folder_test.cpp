// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/dataset/live_folder.h>
#include <pcl_semantic/dataset/live_rgbd.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

class FillingFolder : public testing::Test {
protected:
  void
  SetUp() override
  {
    for (const char* const name : {"image_2", "image_3"})
      fs::create_directories(folder.path(name));
    std::string text;
    for (const char* const row : {"P0: 500 0 60 0", "P1: 500 0 60 -100",
                                  "P2: 500 0 60 30", "P3: 500 0 60 -220"})
      text += std::string(row) + " 0 400 40 0 0 0 1 0\n";
    folder.write("calib.txt", text);
  }

  std::string
  imageOf(const char* side, int number) const
  {
    return folder.path(side) + "/" + frameFileName(number, ".png");
  }

  void
  write(const char* side, int number, cv::Size size = {120, 80}) const
  {
    writePng(imageOf(side, number), cv::Mat(size, CV_8UC3, cv::Scalar::all(number)));
  }

  void
  writePair(int number) const
  {
    write("image_2", number);
    write("image_3", number);
  }

  // What another program has written so far.
  void
  cutInHalf(const std::string& path) const
  {
    fs::resize_file(path, fs::file_size(path) / 2);
  }

  // The folder with a pair that has been grabbed.
  std::unique_ptr<LiveCamera>
  opened() const
  {
    writePair(0);
    auto camera = openLiveFolder(folder.path(""));
    EXPECT_EQ(camera->grab(), 1);
    return camera;
  }

  const TemporaryFolder folder;
};

} // namespace

TEST_F(FillingFolder, APairIsThereWhenBothImagesAre)
{
  expectBadInput("holds no whole pair of images yet",
                 [&] { openLiveFolder(folder.path("")); });
  EXPECT_FALSE(holdsPair(folder.path("")));
  writePair(3);
  EXPECT_TRUE(holdsPair(folder.path("")));
  const auto camera = openLiveFolder(folder.path(""));
  EXPECT_EQ(camera->camera().width, 120);
  EXPECT_NEAR(camera->camera().baseline, 0.5, 1e-9);
  EXPECT_EQ(camera->grab(), 1);
  EXPECT_EQ(timeOf(camera->retrieve()).number, 3);
  EXPECT_EQ(camera->grab(), 0);
  write("image_2", 5);
  EXPECT_EQ(camera->grab(), 0);
  write("image_3", 5);
  EXPECT_EQ(camera->grab(), 1);
  const auto frame = std::get<StereoFrame>(camera->retrieve());
  EXPECT_EQ(frame.number, 5);
  EXPECT_EQ(frame.left.at<cv::Vec3b>(40, 60)[0], 5);
  EXPECT_GE(frame.timestamp, 0.0);
  writePair(4); // late: what came after it has been mapped
  EXPECT_EQ(camera->grab(), 0);
  EXPECT_FALSE(camera->hasEnded());
}

TEST_F(FillingFolder, OfManyTheNewestIsGrabbed)
{
  for (int number = 0; number < 120; ++number)
    writePair(number);
  const auto camera = openLiveFolder(folder.path(""));
  EXPECT_EQ(camera->grab(), 120);
  EXPECT_EQ(timeOf(camera->retrieve()).number, 119);
  writePair(130);
  writePair(140);
  EXPECT_EQ(camera->grab(), 2);
  EXPECT_EQ(timeOf(camera->retrieve()).number, 140);
}

TEST_F(FillingFolder, AnImageIsWaitedForUntilItIsWhole)
{
  const auto camera = opened();
  writePair(1);
  cutInHalf(imageOf("image_3", 1));
  EXPECT_EQ(camera->grab(), 0);
  write("image_3", 1);
  EXPECT_EQ(camera->grab(), 1);
  EXPECT_EQ(timeOf(camera->retrieve()).number, 1);
  // One that never is gives way to the next, and counts.
  writePair(2);
  cutInHalf(imageOf("image_2", 2));
  writePair(3);
  EXPECT_EQ(camera->grab(), 2);
  EXPECT_EQ(timeOf(camera->retrieve()).number, 3);
}

TEST_F(FillingFolder, APairThatComesLateIsCountedWithTheNext)
{
  const auto camera = opened();
  writePair(3);
  EXPECT_EQ(camera->grab(), 1);
  writePair(1);
  writePair(2);
  EXPECT_EQ(camera->grab(), 0);
  writePair(4);
  EXPECT_EQ(camera->grab(), 3);
  EXPECT_EQ(timeOf(camera->retrieve()).number, 4);
  writePair(5);
  EXPECT_EQ(camera->grab(), 1);
}

TEST_F(FillingFolder, APipeIsNotWaitedFor)
{
  const auto camera = opened();
  for (const char* const side : {"image_2", "image_3"})
    ASSERT_EQ(::mkfifo(imageOf(side, 1).c_str(), 0600), 0);
  EXPECT_EQ(camera->grab(), 0);
  writePair(2);
  EXPECT_EQ(camera->grab(), 2);
}

TEST_F(FillingFolder, OtherFilesArePassedOver)
{
  const auto camera = opened();
  for (const char* const name : {"20261125134500.png", "left.png", "notes.txt", ".png"})
    folder.write(std::string("image_2/") + name, "x");
  EXPECT_EQ(camera->grab(), 0);
  writePair(1);
  fs::copy_file(imageOf("image_2", 1), folder.path("image_2/1.png")); // once more
  EXPECT_EQ(camera->grab(), 1);
  EXPECT_EQ(timeOf(camera->retrieve()).number, 1);
  fs::remove_all(folder.path("image_2"));
  expectBadInput("image_2: cannot be read", [&] { camera->grab(); });
}

TEST_F(FillingFolder, AnImageOfAnotherSizeIsRefused)
{
  const auto camera = opened();
  write("image_2", 1, {100, 80});
  write("image_3", 1, {100, 80});
  EXPECT_EQ(camera->grab(), 1);
  expectBadInput("has 100 x 80 pixels, expected 120 x 80", [&] { camera->retrieve(); });
}

// As the pairs of a stereo camera; a depth image may come later than its colours.
TEST(FillingRgbd, AFrameIsThereWhenBothImagesAre)
{
  const TemporaryFolder folder;
  RgbdFiles files;
  files.folder = folder.path("");
  files.intrinsics = "50,50,30,20";
  EXPECT_FALSE(holdsRgbdFrame(files.folder));
  for (const char* const name : {"rgb", "depth"})
    fs::create_directories(folder.path(name));
  expectBadInput("holds no whole pair of images in rgb and depth yet",
                 [&] { openLiveRgbd(files, ""); });
  const auto colour = [&](int number) {
    writePng(folder.path("rgb/" + frameFileName(number, ".png")),
             cv::Mat(40, 60, CV_8UC3, cv::Scalar::all(number)));
  };
  const auto depth = [&](int number) {
    writePng(folder.path("depth/" + frameFileName(number, ".png")),
             cv::Mat(40, 60, CV_16UC1, cv::Scalar(1000 + number)));
  };
  colour(1);
  EXPECT_FALSE(holdsRgbdFrame(files.folder));
  depth(1);
  EXPECT_TRUE(holdsRgbdFrame(files.folder));
  const auto camera = openLiveRgbd(files, "");
  EXPECT_TRUE(camera->hasDepth());
  EXPECT_EQ(camera->camera().width, 60);
  EXPECT_EQ(camera->grab(), 1);
  EXPECT_EQ(timeOf(camera->retrieve()).number, 1);
  colour(4);
  EXPECT_EQ(camera->grab(), 0);
  depth(4);
  EXPECT_EQ(camera->grab(), 1);
  const auto frame = std::get<RgbdFrame>(camera->retrieve());
  EXPECT_EQ(frame.number, 4);
  EXPECT_EQ(frame.image.at<cv::Vec3b>(0, 0)[0], 4);
  EXPECT_FLOAT_EQ(frame.cloud->at(30, 20).z, 1.004f);
  EXPECT_EQ(frame.unmeasured, 0u);
}

} // namespace pcl_semantic
