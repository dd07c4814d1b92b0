// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/capture/video_pair_sequence.h>

#include "core/fail.h"
#include "dataset/stereo_pair_reader.h"
#include "images/opencv_settings.h"

#include <pcl_semantic/files/input_file.h>

#include <opencv2/videoio.hpp>

#include <cmath>
#include <filesystem>

namespace pcl_semantic {

namespace {

struct Video {
  explicit Video(const std::string& file) : path(file)
  {
    requireRegularFile(path);
    open();
    const double count = capture.get(cv::CAP_PROP_FRAME_COUNT);
    rate = capture.get(cv::CAP_PROP_FPS);
    if (!(count >= 1.0 && count <= kMaxFrameNumber + 1.0) ||
        !(rate > 0.0 && rate <= 1e4))
      fail<BadInputException>(path, ": states ", count, " frames, ", rate,
                              " a second, expected a complete video");
    frames = std::size_t(count);
  }

  cv::Mat
  frame(std::size_t i)
  {
    const QuietOpenCv quiet;
    if (i < next)
      open();
    for (; next < i; ++next)
      if (!capture.grab())
        failAt(next);
    cv::Mat image;
    if (!capture.read(image) || image.type() != CV_8UC3)
      failAt(i);
    ++next;
    return image.clone(); // the decoder reuses its memory
  }

  void
  open()
  {
    const QuietOpenCv quiet;
    next = 0;
    if (!capture.open(path, cv::CAP_FFMPEG) || !capture.isOpened())
      fail<BadInputException>(path, ": is no video that OpenCV reads");
  }

  [[noreturn]] void
  failAt(std::size_t i) const
  {
    fail<BadInputException>(path, ": frame ", i, " cannot be read, expected ", frames,
                            " frames");
  }

  std::string path;
  cv::VideoCapture capture;
  double rate = 0.0; // frames per second
  std::size_t frames = 0, next = 0;
};

} // namespace

struct VideoPairSequence::Videos {
  Video left, right;
  RectifiedPair pair;
  std::vector<double> times; // [s]; empty: computed from the rate
};

VideoPairSequence::VideoPairSequence(const ImagePairFiles& files)
    : videos_(new Videos{Video(files.left), Video(files.right), {}, {}})
{
  Video &left = videos_->left, &right = videos_->right;
  if (left.frames != right.frames || std::abs(left.rate - right.rate) > 0.01)
    fail<BadInputException>(left.path, ": has ", left.frames, " frames, ", left.rate,
                            " a second, but ", right.path, " has ", right.frames, ", ",
                            right.rate, " a second");
  const cv::Size size = left.frame(0).size();
  if (right.frame(0).size() != size)
    fail<BadInputException>(left.path, " and ", right.path,
                            ": have images of different sizes");
  videos_->pair = readRectifiedPair({files.calibration, files.extrinsics},
                                    {size, left.path}, KittiCameras::colour);
  if (!files.times.empty())
    videos_->times = readTimesOf(files.times, left.frames, "frames");
}

VideoPairSequence::~VideoPairSequence() = default;

std::size_t
VideoPairSequence::size() const
{
  return videos_->left.frames;
}

double
VideoPairSequence::timestamp(std::size_t i) const
{
  return videos_->times.empty() ? double(i) / videos_->left.rate : videos_->times.at(i);
}

StereoFrame
VideoPairSequence::frame(std::size_t i) const
{
  StereoFrame frame{
      {frameNumber(i), timestamp(i)}, videos_->left.frame(i), videos_->right.frame(i)};
  videos_->pair.rectify(frame);
  return frame;
}

const StereoCamera&
VideoPairSequence::camera() const
{
  return videos_->pair.camera;
}

const Eigen::Isometry3d&
VideoPairSequence::T_camera0_camera() const
{
  return videos_->pair.T_camera0_camera;
}

const std::vector<std::string>&
VideoPairSequence::doubts() const
{
  return videos_->pair.doubts;
}

} // namespace pcl_semantic
