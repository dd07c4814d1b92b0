// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/capture/live_capture.h>

#include "core/fail.h"
#include "images/opencv_settings.h"

#include <pcl_semantic/capture/video_pair_sequence.h>

#include <opencv2/videoio.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

namespace pcl_semantic {

namespace {

using Clock = std::chrono::steady_clock;

bool
isNumber(const std::string& text)
{
  return !text.empty() && text.size() < 4 &&
         text.find_first_not_of("0123456789") == std::string::npos;
}

constexpr int longest_silence = 5000; // of a stream [ms]

void
open(cv::VideoCapture& capture, const std::string& name)
{
  const QuietOpenCv quiet;
  // Named backends only: by default OpenCV also asks gPhoto for cameras, which searches
  // all USB devices and leaks memory.
  bool is_open = false;
  if (isNumber(name))
    is_open = capture.open(std::stoi(name), cv::CAP_V4L2);
  else if (name.rfind("/dev/", 0) == 0)
    is_open = capture.open(name, cv::CAP_V4L2);
  else if (name.find("://") != std::string::npos) // a silent stream times out
    is_open = capture.open(name, cv::CAP_FFMPEG,
                           {cv::CAP_PROP_OPEN_TIMEOUT_MSEC, longest_silence,
                            cv::CAP_PROP_READ_TIMEOUT_MSEC, longest_silence});
  else
    is_open = capture.open(name, cv::CAP_FFMPEG);
  if (!is_open || !capture.isOpened())
    fail<BadInputException>(name, ": cannot be opened, expected a video, a camera's "
                                  "number or device, or the address of a stream");
  capture.set(cv::CAP_PROP_BUFFERSIZE, 1); // newest only; some ignore it
}

// One camera per side, or one that provides both sides next to each other.
class LiveCapture : public LiveCamera {
public:
  explicit LiveCapture(const ImagePairFiles& files) : files_(files)
  {
    open(left_, files.left);
    if (files.left != files.right)
      open(right_.emplace(), files.right);
    if (isVideo(files.left)) {
      const double rate = left_.get(cv::CAP_PROP_FPS);
      if (!(rate > 0.0 && rate <= 1e4))
        fail<BadInputException>(files.left, ": states ", rate,
                                " frames a second, expected more than 0");
      last_ = int(left_.get(cv::CAP_PROP_FRAME_COUNT)) - 1;
      period_ = std::chrono::duration_cast<Clock::duration>(
          std::chrono::duration<double>(1.0 / rate));
    }
    if (!grabBoth())
      fail<BadInputException>(files.left, ": gives no image");
    const StereoFrame first = decoded();
    pair_ = readRectifiedPair({files.calibration, files.extrinsics},
                              {first.left.size(), files.left}, KittiCameras::colour);
  }

  // Waits for the next image of a camera; plays a video at its rate.
  int
  grab() override
  {
    if (std::exchange(is_first_, false)) { // the constructor grabbed it
      begin_ = when_ = Clock::now();
      return 1;
    }
    if (period_ > Clock::duration::zero()) {
      const Clock::time_point due = begin_ + (number_ + 1) * period_;
      const auto wait = due - Clock::now();
      std::this_thread::sleep_for(std::min<Clock::duration>(wait, longest_wait));
      if (wait > longest_wait)
        return 0;
    }
    // Grabbing beyond the end of a video would lose the last pair.
    if (number_ == last_ || !grabBoth()) {
      has_ended_ = true;
      is_lost_ = number_ != last_;
      return 0;
    }
    ++number_;
    when_ = Clock::now();
    return 1;
  }

  bool
  hasEnded() const override
  {
    return has_ended_;
  }

  SensorFrame
  retrieve() override
  {
    if (is_lost_)
      fail<BadInputException>(files_.left, ": ended before frame ", number_,
                              " was decoded");
    StereoFrame frame = decoded();
    frame.number = number_;
    frame.timestamp = std::chrono::duration<double>(when_ - begin_).count();
    if (frame.left.size() != cv::Size(camera().width, camera().height))
      fail<BadInputException>(files_.left, ": frame ", number_, " is ", frame.left.cols,
                              " x ", frame.left.rows, ", expected ", camera().width,
                              " x ", camera().height, " as the first");
    pair_.rectify(frame);
    return frame;
  }

private:
  static constexpr std::chrono::milliseconds longest_wait{50};

  // Grabs both before decoding either, so that their times agree.
  bool
  grabBoth()
  {
    const QuietOpenCv quiet;
    return left_.grab() && (!right_ || right_->grab());
  }

  static cv::Mat
  imageOf(cv::VideoCapture& capture, const std::string& name)
  {
    cv::Mat image;
    if (!capture.retrieve(image) || image.type() != CV_8UC3)
      fail<BadInputException>(name, ": an image cannot be decoded");
    return image.clone(); // the decoder reuses its memory
  }

  StereoFrame
  decoded()
  {
    const QuietOpenCv quiet;
    StereoFrame frame;
    frame.left = imageOf(left_, files_.left);
    if (right_)
      frame.right = imageOf(*right_, files_.right);
    else {
      const cv::Mat both = frame.left;
      frame.left = both.colRange(0, both.cols / 2).clone();
      frame.right = both.colRange(both.cols / 2, both.cols / 2 * 2).clone();
    }
    if (frame.left.size() != frame.right.size())
      fail<BadInputException>(files_.left, " and ", files_.right,
                              ": have images of different sizes");
    return frame;
  }

  ImagePairFiles files_;
  cv::VideoCapture left_;
  std::optional<cv::VideoCapture> right_; // none: left_ provides both sides
  Clock::duration period_{};              // of a video; 0 for a camera
  Clock::time_point begin_, when_;
  int number_ = 0;       // number of the newest pair, from 0
  int last_ = -1;        // last number of a video
  bool is_first_ = true; // pair
  bool is_lost_ = false; // the newest pair
  bool has_ended_ = false;
};

} // namespace

bool
isCapture(const std::string& name)
{
  return isNumber(name) || name.rfind("/dev/", 0) == 0 ||
         name.find("://") != std::string::npos;
}

std::unique_ptr<LiveCamera>
openCaptures(const ImagePairFiles& files)
{
  return std::make_unique<LiveCapture>(files);
}

} // namespace pcl_semantic
