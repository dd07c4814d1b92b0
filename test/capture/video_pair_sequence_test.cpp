// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_rigs.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/capture/live_capture.h>
#include <pcl_semantic/capture/video_pair_sequence.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include <filesystem>

namespace pcl_semantic {

namespace {

// A video whose n-th image is grey 20 n + 40, its right half lighter.
void
writeVideo(const std::string& path, int frames, cv::Size size = {640, 480},
           double rate = 5.0, int lighter = 0)
{
  cv::VideoWriter writer(path, cv::CAP_FFMPEG,
                         cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate, size);
  ASSERT_TRUE(writer.isOpened());
  for (int n = 0; n < frames; ++n) {
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

class VideoPairs : public ::testing::Test {
protected:
  void
  SetUp() override
  {
    writeRig(folder.path("rig.yaml"), exampleRig());
    writeVideo(files.left, 4);
    writeVideo(files.right, 4);
  }

  void
  expectRefused(const std::string& says) const
  {
    expectBadInput(says, [&] { VideoPairSequence{files}; });
  }

  // All pairs, as cameras would take them.
  std::vector<StereoFrame>
  play() const
  {
    const auto camera = openCaptures(files);
    std::vector<StereoFrame> frames;
    while (!camera->hasEnded())
      if (camera->grab())
        frames.push_back(std::get<StereoFrame>(camera->retrieve()));
    return frames;
  }

  const TemporaryFolder folder;
  ImagePairFiles files{folder.path("left.avi"), folder.path("right.avi"),
                       folder.path("rig.yaml"), "", ""};
};

} // namespace

TEST_F(VideoPairs, FramesComeInAnyOrder)
{
  const VideoPairSequence videos(files);
  ASSERT_EQ(videos.size(), 4u);
  EXPECT_EQ(videos.timestamp(2), 0.4);
  for (const std::size_t i : {0, 1, 3, 1, 1, 2})
    EXPECT_NEAR(greyOf(videos.frame(i).left), 20.0 * double(i) + 40.0, 3.0) << i;
  EXPECT_EQ(videos.frame(0).left.size(),
            cv::Size(videos.camera().width, videos.camera().height));
  EXPECT_TRUE(isVideo("a.mp4"));
  EXPECT_FALSE(isVideo("a.png"));
}

TEST_F(VideoPairs, TimesMayComeFromAFile)
{
  files.times = folder.write("times.txt", "0\n1\n2.5\n3\n");
  EXPECT_EQ(VideoPairSequence(files).timestamp(2), 2.5);
  folder.write("times.txt", "0\n1\n");
  expectRefused("has 2 times for 4 frames");
}

TEST_F(VideoPairs, RefusesWhatIsNoPair)
{
  writeVideo(files.right, 3);
  expectRefused("left.avi: has 4 frames, 5 a second");
  writeVideo(files.right, 4, {320, 240});
  expectRefused("have images of different sizes");
  writeVideo(files.right, 4, {640, 480}, 10.0);
  expectRefused("10 a second");
  folder.write("right.avi", "no video at all");
  expectRefused("right.avi: is no video that OpenCV reads");
  std::filesystem::remove(files.right);
  expectRefused("right.avi: cannot be read");
}

TEST_F(VideoPairs, ACutOffVideoNamesTheFrame)
{
  const VideoPairSequence whole(files);
  std::filesystem::resize_file(files.left,
                               std::filesystem::file_size(files.left) * 6 / 10);
  expectBadInput("left.avi", [&] {
    const VideoPairSequence videos(files);
    for (std::size_t i = 0; i < videos.size(); ++i)
      videos.frame(i);
  });
}

TEST_F(VideoPairs, VideosArePlayedAtTheirRate)
{
  writeVideo(files.left, 4, {640, 480}, 20.0);
  writeVideo(files.right, 4, {640, 480}, 20.0);
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

TEST_F(VideoPairs, OneImageMayHoldBothSides)
{
  files.right = files.left;
  writeVideo(files.left, 4, {1280, 480}, 20.0, 50);
  const std::vector<StereoFrame> frames = play();
  ASSERT_EQ(frames.size(), 4u);
  EXPECT_NEAR(greyOf(frames[1].left), 60, 3);
  EXPECT_NEAR(greyOf(frames[1].right), 110, 3);
}

TEST_F(VideoPairs, WhatCannotBeOpenedIsNamed)
{
  files.left = folder.path("none.avi");
  expectBadInput("none.avi: cannot be opened", [&] { play(); });
  for (const char* const name : {"0", "12", "/dev/video3", "rtsp://camera/left"})
    EXPECT_TRUE(isCapture(name)) << name;
  for (const char* const name : {"", "left", "a.mp4", "1234", "left/*.png"})
    EXPECT_FALSE(isCapture(name)) << name;
}

} // namespace pcl_semantic
