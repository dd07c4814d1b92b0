// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/live_rgbd.h>

#include "core/fail.h"
#include "files/is_there.h"
#include "new_pairs.h"
#include "rgbd_reader.h"

#include <pcl_semantic/images/image_file.h>

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

namespace pcl_semantic {

namespace {

NewPairs
framesIn(const std::string& folder)
{
  return {folder + "/rgb", folder + "/depth"};
}

class LiveRgbd : public LiveCamera {
public:
  LiveRgbd(const RgbdFiles& files, const PinholeCamera& camera)
      : frames_(framesIn(files.folder)), scale_{files.depth_scale}
  {
    scale_.validate();
    came_ = frames_.next(grabbed_);
    if (came_ == 0)
      badInput(files.folder, ": holds no whole pair of images in rgb and depth yet");
    first_ = grabbed_.left;
    const cv::Mat image = readImage(first_);
    undistorter_.emplace(camera, image.cols, image.rows, first_);
    pair_.camera = undistorter_->camera();
    pair_.doubts = camera.doubts;
  }

  bool
  hasDepth() const override
  {
    return true;
  }

  int
  grab() override
  {
    constexpr std::chrono::milliseconds pause(10);
    const int came = came_ > 0 ? std::exchange(came_, 0) : frames_.next(grabbed_);
    if (came > 0)
      when_ = Clock::now();
    else
      std::this_thread::sleep_for(pause);
    return came;
  }

  bool
  hasEnded() const override
  {
    return false;
  }

  SensorFrame
  retrieve() override
  {
    RgbdFrame frame = readRgbdFrame(grabbed_.left, grabbed_.right, *undistorter_,
                                    scale_, 0.0, first_);
    frame.number = grabbed_.frame;
    frame.timestamp = std::chrono::duration<double>(when_ - begin_).count();
    return frame;
  }

private:
  using Clock = std::chrono::steady_clock;

  NewPairs frames_;
  DepthScale scale_;
  std::optional<Undistorter> undistorter_;
  std::string first_; // path of the first image
  StereoPairFiles grabbed_;
  int came_ = 0; // from the constructor
  Clock::time_point begin_ = Clock::now(), when_;
};

} // namespace

bool
holdsRgbdFrame(const std::string& folder)
{
  StereoPairFiles pair;
  return isFolder(folder + "/rgb") && isFolder(folder + "/depth") &&
         framesIn(folder).next(pair) > 0;
}

std::unique_ptr<LiveCamera>
openLiveRgbd(const RgbdFiles& files, const std::string& calibration)
{
  return std::make_unique<LiveRgbd>(files,
                                    pinholeCameraOf(calibration, files.intrinsics));
}

} // namespace pcl_semantic
