// SPDX-License-Identifier: BSD-3-Clause
#include "files/quiet_opencv.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/video_pair_sequence.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <opencv2/videoio.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace pcl_semantic {

namespace {

class Video {
public:
  explicit Video(const std::string& path) : path_(path)
  {
    if (!std::ifstream(path))
      PCL_THROW_EXCEPTION(BadInputException, path << ": cannot be read");
    open();
    const double frames = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    rate_ = capture_.get(cv::CAP_PROP_FPS);
    if (!(frames >= 1.0 && frames <= kMaxFrameNumber + 1.0) ||
        !(rate_ > 0.0 && rate_ <= 1e4))
      PCL_THROW_EXCEPTION(BadInputException, path << ": states " << frames
                                                  << " frames, " << rate_
                                                  << " a second: no whole video");
    frames_ = std::size_t(frames);
  }

  std::size_t
  size() const
  {
    return frames_;
  }

  // Frames a second.
  double
  rate() const
  {
    return rate_;
  }

  const std::string&
  path() const
  {
    return path_;
  }

  cv::Mat
  frame(std::size_t i)
  {
    const QuietOpenCv quiet;
    if (i < next_)
      open();
    for (; next_ < i; ++next_)
      if (!capture_.grab())
        failAt(next_);
    cv::Mat image;
    if (!capture_.read(image) || image.type() != CV_8UC3)
      failAt(i);
    ++next_;
    return image.clone(); // it is the decoder's
  }

private:
  void
  open()
  {
    const QuietOpenCv quiet;
    next_ = 0;
    if (!capture_.open(path_, cv::CAP_FFMPEG) || !capture_.isOpened())
      PCL_THROW_EXCEPTION(BadInputException,
                          path_ << ": is no video that OpenCV reads");
  }

  [[noreturn]] void
  failAt(std::size_t i) const
  {
    PCL_THROW_EXCEPTION(BadInputException, path_ << ": frame " << i
                                                 << " cannot be read, expected "
                                                 << frames_ << " frames");
  }

  std::string path_;
  cv::VideoCapture capture_;
  double rate_ = 0.0;
  std::size_t frames_ = 0, next_ = 0;
};

} // namespace

bool
isVideo(const std::string& path)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".mp4" || extension == ".avi" || extension == ".mkv" ||
         extension == ".mov";
}

struct VideoPairSequence::Videos {
  Video left, right;
  RectifiedPair pair;
  std::vector<double> times; // empty: by the rate
};

VideoPairSequence::VideoPairSequence(const ImagePairFiles& files)
    : videos_(new Videos{Video(files.left), Video(files.right), {}, {}})
{
  Video &left = videos_->left, &right = videos_->right;
  if (left.size() != right.size() || std::abs(left.rate() - right.rate()) > 0.01)
    PCL_THROW_EXCEPTION(BadInputException,
                        left.path()
                            << ": has " << left.size() << " frames, " << left.rate()
                            << " a second, but " << right.path() << " has "
                            << right.size() << ", " << right.rate() << " a second");
  const cv::Size size = left.frame(0).size();
  if (right.frame(0).size() != size)
    PCL_THROW_EXCEPTION(BadInputException, left.path()
                                               << " and " << right.path()
                                               << ": have images of different sizes");
  videos_->pair = readRectifiedPair({files.calibration, files.extrinsics},
                                    {size, left.path()}, KittiCameras::colour);
  if (files.times.empty())
    return;
  videos_->times = readTimes(files.times);
  if (videos_->times.size() < left.size())
    PCL_THROW_EXCEPTION(BadInputException,
                        files.times << ": has " << videos_->times.size()
                                    << " times for " << left.size() << " frames");
}

VideoPairSequence::~VideoPairSequence() = default;

std::size_t
VideoPairSequence::size() const
{
  return videos_->left.size();
}

double
VideoPairSequence::timestamp(std::size_t i) const
{
  return videos_->times.empty() ? double(i) / videos_->left.rate()
                                : videos_->times.at(i);
}

StereoFrame
VideoPairSequence::frame(std::size_t i) const
{
  StereoFrame frame;
  frame.number = frameNumber(i);
  frame.timestamp = timestamp(i);
  frame.left = videos_->left.frame(i);
  frame.right = videos_->right.frame(i);
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

} // namespace pcl_semantic
