// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/live_camera.h>

#include "core/fail.h"
#include "stereo_pair_reader.h"

#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <filesystem>
#include <fstream>
#include <thread>
#include <utility>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

struct PairFolders {
  std::string left, right;
};

// Of KITTI's colour pair, or else of its grey one.
PairFolders
foldersIn(const std::string& folder)
{
  return fs::is_directory(folder + "/image_2")
             ? PairFolders{folder + "/image_2", folder + "/image_3"}
             : PairFolders{folder + "/image_0", folder + "/image_1"};
}

// Whether a PNG has been written to its end, the chunk IEND.
bool
isWhole(const std::string& path)
{
  constexpr std::array<char, 8> end = {'I',    'E',    'N',    'D',
                                       '\xae', '\x42', '\x60', '\x82'};
  std::ifstream file(path, std::ios::binary);
  std::array<char, 8> last{};
  return file.seekg(-std::streamoff(end.size()), std::ios::end) &&
         file.read(last.data(), last.size()) && last == end;
}

// The pairs of two folders that grow, in the order of their numbers.
class NewPairs {
public:
  explicit NewPairs(PairFolders folders) : folders_(std::move(folders)) {}

  // The next pair, if it is whole. One that is not is waited for until a later one is.
  bool
  next(StereoPairFiles& pair)
  {
    look();
    const auto whole =
        std::find_if(found_.begin(), found_.end(), [&](const FrameFile& file) {
          return isWhole(file.path) && isWhole(rightOf(file));
        });
    if (whole == found_.end())
      return false;
    pair = {whole->path, rightOf(*whole), whole->frame};
    last_ = whole->frame;
    found_.erase(found_.begin(), whole + 1);
    return true;
  }

private:
  std::string
  rightOf(const FrameFile& left) const
  {
    return folders_.right + "/" + fs::path(left.path).filename().string();
  }

  // Lists the left images, if one has come since: a folder may hold many.
  void
  look()
  {
    const fs::file_time_type changed = fs::last_write_time(folders_.left);
    if (changed == seen_)
      return;
    found_.clear();
    for (const FrameFile& file : listFrameFiles(folders_.left, {".png"}))
      if (file.frame > last_)
        found_.push_back(file);
    // The clock of files is coarse: what comes in the same moment must not be missed.
    constexpr std::chrono::milliseconds moment(100);
    if (fs::file_time_type::clock::now() - changed > moment)
      seen_ = changed;
  }

  PairFolders folders_;
  std::deque<FrameFile> found_; // left images behind last_
  int last_ = -1;               // number of the pair that was given out last
  fs::file_time_type seen_ = fs::file_time_type::min();
};

class LiveFolder : public LiveCamera {
public:
  explicit LiveFolder(const std::string& folder) : pairs_(foldersIn(folder))
  {
    if (!pairs_.next(next_))
      fail<BadInputException>(folder, ": holds no whole pair of images yet");
    has_next_ = true;
    const cv::Mat first = readFrameImage(next_.left, next_.frame);
    const KittiCalibration calibration = readCalibrationOf(
        first.size(), folder + "/calib.txt",
        first.channels() == 1 ? KittiCameras::grey : KittiCameras::colour);
    pair_.camera = calibration.camera;
    pair_.T_camera0_camera = calibration.T_camera0_camera;
  }

  bool
  grab() override
  {
    constexpr std::chrono::milliseconds pause(10);
    if (!has_next_ && !pairs_.next(next_)) {
      std::this_thread::sleep_for(pause);
      return false;
    }
    has_next_ = false;
    grabbed_ = next_;
    when_ = Clock::now();
    return true;
  }

  bool
  hasEnded() const override
  {
    return false;
  }

  StereoFrame
  retrieve() override
  {
    StereoFrame frame = readStereoPair(grabbed_, {camera().width, camera().height});
    frame.timestamp = std::chrono::duration<double>(when_ - begin_).count();
    return frame;
  }

private:
  using Clock = std::chrono::steady_clock;

  NewPairs pairs_;
  StereoPairFiles next_, grabbed_;
  bool has_next_ = false; // next_ was found and not grabbed yet
  Clock::time_point begin_ = Clock::now(), when_;
};

} // namespace

bool
holdsPair(const std::string& folder)
{
  const PairFolders folders = foldersIn(folder);
  StereoPairFiles pair;
  return fs::is_directory(folders.left) && fs::is_directory(folders.right) &&
         fs::exists(folder + "/calib.txt") && NewPairs(folders).next(pair);
}

std::unique_ptr<LiveCamera>
openLiveFolder(const std::string& folder)
{
  if (!fs::is_directory(folder))
    fail<BadInputException>(folder, ": is no folder, expected one in KITTI's layout "
                                    "that another program fills");
  return std::make_unique<LiveFolder>(folder);
}

} // namespace pcl_semantic
