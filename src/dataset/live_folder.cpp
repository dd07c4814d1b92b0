// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/live_folder.h>

#include "core/fail.h"
#include "core/parse_whole.h"
#include "files/is_there.h"
#include "stereo_pair_reader.h"

#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

struct PairFolders {
  std::string left, right;
};

// KITTI's colour pair if it exists, else its grey pair.
PairFolders
foldersIn(const std::string& folder)
{
  return isFolder(folder + "/image_2")
             ? PairFolders{folder + "/image_2", folder + "/image_3"}
             : PairFolders{folder + "/image_0", folder + "/image_1"};
}

// Whether a PNG is complete: it ends with the chunk IEND.
bool
isWhole(const std::string& path)
{
  constexpr std::array<char, 8> end = {'I',    'E',    'N',    'D',
                                       '\xae', '\x42', '\x60', '\x82'};
  std::error_code error;
  if (!fs::is_regular_file(path, error))
    return false; // reading a pipe would block
  std::ifstream file(path, std::ios::binary);
  std::array<char, 8> last{};
  return file.seekg(-std::streamoff(end.size()), std::ios::end) &&
         file.read(last.data(), last.size()) && last == end;
}

// The pairs of two growing folders.
class NewPairs {
public:
  explicit NewPairs(PairFolders folders) : folders_(std::move(folders)) {}

  // Finds the newest complete pair. Returns the number of new pairs; 0 = none.
  int
  next(StereoPairFiles& pair)
  {
    look();
    const auto whole =
        std::find_if(found_.rbegin(), found_.rend(), [&](const FrameFile& file) {
          return isWhole(file.path) && isWhole(rightOf(file));
        });
    if (whole == found_.rend())
      return 0;
    pair = {whole->path, rightOf(*whole), whole->frame};
    last_ = whole->frame;
    const auto came = int(found_.rend() - whole) + passed_;
    behind_ += came;
    passed_ = 0;
    found_.erase(found_.begin(), whole.base());
    return came;
  }

private:
  static constexpr std::size_t most = 100; // maximum of checked pairs

  std::string
  rightOf(const FrameFile& left) const
  {
    return folders_.right + "/" + fs::path(left.path).filename().string();
  }

  // Lists the left images only after a change, because a folder may be large.
  void
  look()
  {
    std::error_code error;
    const fs::file_time_type changed = fs::last_write_time(folders_.left, error);
    if (error)
      fail<BadInputException>(folders_.left, ": cannot be read: ", error.message());
    if (changed == seen_)
      return;
    found_.clear();
    int behind = 0;
    for (const fs::directory_entry& entry :
         fs::directory_iterator(folders_.left, error))
      behind += isBehind(entry.path());
    const int late = std::max(behind - behind_, 0);
    behind_ = behind - late; // late ones are not counted yet
    std::sort(found_.begin(), found_.end(), [](const FrameFile& a, const FrameFile& b) {
      return a.frame != b.frame ? a.frame < b.frame : a.path < b.path;
    });
    const int older = int(found_.size() - std::min(most, found_.size()));
    found_.erase(found_.begin(), found_.begin() + older);
    passed_ = older + late;
    // File times are coarse: list again if another file could have the same time.
    constexpr std::chrono::milliseconds moment(20);
    if (fs::file_time_type::clock::now() - changed > moment)
      seen_ = changed;
  }

  // Whether the file belongs to the last pair or earlier; collects later ones.
  bool
  isBehind(const fs::path& path)
  {
    int number = 0;
    if (path.extension() != ".png" || !parseWhole(path.stem().string(), number) ||
        number > kMaxFrameNumber)
      return false;
    if (number > last_)
      found_.push_back({number, path.string()});
    return number <= last_;
  }

  PairFolders folders_;
  std::vector<FrameFile> found_; // left images after last_, by number
  int passed_ = 0;               // older unchecked or late ones
  int behind_ = 0;               // counted files up to last_
  int last_ = -1;                // number of the last returned pair
  fs::file_time_type seen_ = fs::file_time_type::min();
};

class LiveFolder : public LiveCamera {
public:
  explicit LiveFolder(const std::string& folder) : pairs_(foldersIn(folder))
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
  StereoPairFiles grabbed_;
  int came_ = 0; // from the constructor
  Clock::time_point begin_ = Clock::now(), when_;
};

} // namespace

bool
holdsPair(const std::string& folder)
{
  const PairFolders folders = foldersIn(folder);
  StereoPairFiles pair;
  return isFolder(folders.left) && isFolder(folders.right) &&
         isThere(folder + "/calib.txt") && NewPairs(folders).next(pair) > 0;
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
