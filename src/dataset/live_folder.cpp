// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/live_folder.h>

#include "core/fail.h"
#include "files/is_there.h"
#include "new_pairs.h"

#include <chrono>
#include <string>
#include <thread>
#include <utility>

namespace pcl_semantic {

namespace {

// KITTI's colour pair if it exists, else its grey pair.
std::pair<std::string, std::string>
foldersIn(const std::string& folder)
{
  if (isFolder(folder + "/image_2"))
    return {folder + "/image_2", folder + "/image_3"};
  return {folder + "/image_0", folder + "/image_1"};
}

NewPairs
pairsIn(const std::string& folder)
{
  auto [left, right] = foldersIn(folder);
  return {std::move(left), std::move(right)};
}

class LiveFolder : public LiveCamera {
public:
  explicit LiveFolder(const std::string& folder) : pairs_(pairsIn(folder))
  {
    came_ = pairs_.next(grabbed_);
    if (came_ == 0)
      fail<BadInputException>(folder, ": holds no whole pair of images yet");
    const cv::Mat first = readFrameImage(grabbed_.left, grabbed_.frame);
    const KittiCalibration calibration = readCalibrationOf(
        first.size(), grabbed_.left, folder + "/calib.txt",
        first.channels() == 1 ? KittiCameras::grey : KittiCameras::colour);
    pair_.camera = calibration.camera;
    pair_.T_camera0_camera = calibration.T_camera0_camera;
  }

  int
  grab() override
  {
    constexpr std::chrono::milliseconds pause(10);
    const int came = came_ > 0 ? std::exchange(came_, 0) : pairs_.next(grabbed_);
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
    StereoFrame frame = readStereoPair(grabbed_, {camera().width, camera().height});
    frame.timestamp = std::chrono::duration<double>(when_ - begin_).count();
    return frame;
  }

private:
  using Clock = std::chrono::steady_clock;

  NewPairs pairs_;
  StereoPairFiles grabbed_;
  int came_ = 0; // from the constructor
  Clock::time_point begin_ = Clock::now(), when_;
};

} // namespace

bool
holdsPair(const std::string& folder)
{
  const auto [left, right] = foldersIn(folder);
  StereoPairFiles pair;
  return isFolder(left) && isFolder(right) && isThere(folder + "/calib.txt") &&
         NewPairs(left, right).next(pair) > 0;
}

std::unique_ptr<LiveCamera>
openLiveFolder(const std::string& folder)
{
  if (!isFolder(folder))
    fail<BadInputException>(folder, ": is no folder, expected one in KITTI's layout "
                                    "that another program fills");
  return std::make_unique<LiveFolder>(folder);
}

} // namespace pcl_semantic
