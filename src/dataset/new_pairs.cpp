// SPDX-License-Identifier: BSD-3-Clause
#include "new_pairs.h"

#include "core/fail.h"
#include "core/parse_whole.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <utility>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMost = 100; // maximum of checked pairs

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

} // namespace

NewPairs::NewPairs(std::string left, std::string right)
    : left_(std::move(left)), right_(std::move(right))
{}

int
NewPairs::next(StereoPairFiles& pair)
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

std::string
NewPairs::rightOf(const FrameFile& left) const
{
  return right_ + "/" + fs::path(left.path).filename().string();
}

// Lists the left images only after a change, because a folder may be large.
void
NewPairs::look()
{
  std::error_code error;
  const fs::file_time_type changed = fs::last_write_time(left_, error);
  if (error)
    fail<BadInputException>(left_, ": cannot be read: ", error.message());
  if (changed == seen_)
    return;
  found_.clear();
  int behind = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(left_, error))
    behind += isBehind(entry.path());
  const int late = std::max(behind - behind_, 0);
  behind_ = behind - late; // late ones are not counted yet
  std::sort(found_.begin(), found_.end(), [](const FrameFile& a, const FrameFile& b) {
    return a.frame != b.frame ? a.frame < b.frame : a.path < b.path;
  });
  const int older = int(found_.size() - std::min(kMost, found_.size()));
  found_.erase(found_.begin(), found_.begin() + older);
  passed_ = older + late;
  // File times are coarse: list again if another file could have the same time.
  constexpr std::chrono::milliseconds moment(20);
  if (fs::file_time_type::clock::now() - changed > moment)
    seen_ = changed;
}

// Whether the file belongs to the last pair or earlier; collects later ones.
bool
NewPairs::isBehind(const fs::path& path)
{
  int number = 0;
  if (path.extension() != ".png" || !parseWhole(path.stem().string(), number) ||
      number > kMaxFrameNumber)
    return false;
  if (number > last_)
    found_.push_back({number, path.string()});
  return number <= last_;
}

} // namespace pcl_semantic
