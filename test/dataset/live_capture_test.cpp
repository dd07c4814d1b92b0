// SPDX-License-Identifier: BSD-3-Clause
#include "support/refusal.h"
#include "support/stereo_rigs.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/live_capture.h>

#include <gtest/gtest.h>
#include <opencv2/videoio.hpp>

#include <string>
#include <vector>

namespace pcl_semantic {

namespace {

// A video of four images, 20 a second; the n-th is grey 20 n + 40, its right half
// lighter.
void
writeVideo(const std::string& path, cv::Size size, int lighter)
{
  cv::VideoWriter writer(path, cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0, size);
  ASSERT_TRUE(writer.isOpened());
  for (int n = 0; n < 4; ++n) {
    cv::Mat image(size, CV_8UC3, cv::Scalar::all(20 * n + 40));
    image.colRange(size.width / 2, size.width) += cv::Scalar::all(lighter);
    writer << image;
  }
}

int
greyOf(const cv::Mat& image)
{
  return image.at<cv::Vec3b>(240, 320)[1];
}

class Captures : public testing::Test {
protected:
  void
  SetUp() override
  {
    writeRig(folder.path("rig.yaml"), exampleRig());
  }

  // All of them, with what is seen of them.
  std::vector<StereoFrame>
  play() const
  {
    const auto camera = openCaptures(files);
    std::vector<StereoFrame> frames;
    while (!camera->hasEnded())
      if (camera->grab())
        frames.push_back(camera->retrieve());
    return frames;
  }

  const TemporaryFolder folder;
  ImagePairFiles files{folder.path("left.avi"), folder.path("right.avi"),
                       folder.path("rig.yaml"), "", ""};
};

} // namespace

TEST_F(Captures, VideosArePlayedAtTheirRate)
{
  writeVideo(files.left, {640, 480}, 0);
  writeVideo(files.right, {640, 480}, 0);
  const std::vector<StereoFrame> frames = play();
  ASSERT_EQ(frames.size(), 4u);
  for (int n = 0; n < 4; ++n) {
    const StereoFrame& frame = frames[std::size_t(n)];
    EXPECT_EQ(frame.number, n);
    EXPECT_GE(frame.timestamp, 0.05 * n);
    EXPECT_NEAR(greyOf(frame.left), 20 * n + 40, 3);
    EXPECT_NEAR(greyOf(frame.right), 20 * n + 40, 3);
  }
}

TEST_F(Captures, OneImageMayHoldBothSides)
{
  files.right = files.left;
  writeVideo(files.left, {1280, 480}, 50);
  const std::vector<StereoFrame> frames = play();
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_NEAR(greyOf(frames[1].left), 60, 3);
  EXPECT_NEAR(greyOf(frames[1].right), 110, 3);
}

TEST_F(Captures, WhatCannotBeOpenedIsNamed)
{
  files.left = folder.path("none.avi");
  expectRefusal<BadInputException>("none.avi: cannot be opened", [&] { play(); });
  for (const char* const name : {"0", "12", "/dev/video3", "rtsp://camera/left"})
    EXPECT_TRUE(isCapture(name)) << name;
  for (const char* const name : {"", "left", "a.mp4", "1234", "left/*.png"})
    EXPECT_FALSE(isCapture(name)) << name;
}

} // namespace pcl_semantic
