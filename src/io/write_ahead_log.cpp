// SPDX-License-Identifier: BSD-3-Clause
#include "write_ahead_log.h"

#include "files/bytes.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/input_file.h>

#include <algorithm>
#include <array>
#include <fstream>

namespace pcl_semantic {

namespace {

constexpr std::size_t kHeader = 32;          // bytes of the log
constexpr std::size_t kFrameHeader = 24;     // bytes before each page
constexpr std::uint32_t kMagic = 0x377F0682; // its last bit: words are big-endian

std::uint32_t
wordAt(const std::uint8_t* bytes, bool is_big_endian = true)
{
  return std::uint32_t(wholeNumber(bytes, 4, is_big_endian));
}

// The running check sum of a log.
class CheckSum {
public:
  explicit CheckSum(bool is_big_endian) : is_big_endian_(is_big_endian) {}

  void
  add(const std::uint8_t* bytes, std::size_t size)
  {
    for (std::size_t i = 0; i + 8 <= size; i += 8) {
      sums_[0] += wordAt(bytes + i, is_big_endian_) + sums_[1];
      sums_[1] += wordAt(bytes + i + 4, is_big_endian_) + sums_[0];
    }
  }

  bool
  isThatAt(const std::uint8_t* bytes) const
  {
    return sums_[0] == wordAt(bytes) && sums_[1] == wordAt(bytes + 4);
  }

private:
  bool is_big_endian_;
  std::array<std::uint32_t, 2> sums_{};
};

Bytes
contentOf(const std::string& path)
{
  try {
    return readBytes(path);
  }
  catch (const BadInputException&) { // there is none, or its writer has just ended it
    return {};
  }
}

} // namespace

WriteAheadLog::WriteAheadLog(const std::string& path) : bytes_(contentOf(path))
{
  if (bytes_.size() < kHeader || (wordAt(bytes_.data()) & ~1u) != kMagic)
    return;
  page_size_ = wordAt(&bytes_[8]);
  constexpr std::size_t smallest = 512, largest = 65536;
  if (page_size_ < smallest || page_size_ > largest)
    page_size_ = 0;
  follow();
  // A writer may have begun it anew while it was read.
  std::array<char, kHeader> again{};
  std::ifstream(path, std::ios::binary).read(again.data(), again.size());
  if (!std::equal(again.begin(), again.end(), bytes_.begin(),
                  [](char a, std::uint8_t b) { return std::uint8_t(a) == b; }))
    lost_commits_ = 0;
}

std::size_t
WriteAheadLog::frames() const
{
  return page_size_ == 0 ? 0 : (bytes_.size() - kHeader) / (kFrameHeader + page_size_);
}

// Goes from frame to frame as long as salt and check sums fit.
void
WriteAheadLog::follow()
{
  CheckSum sum((wordAt(bytes_.data()) & 1) != 0);
  sum.add(bytes_.data(), 24);
  bool is_sound = sum.isThatAt(&bytes_[24]);
  end_ = kHeader;
  for (std::size_t i = 0; i < frames(); ++i) {
    const std::uint8_t* const frame =
        &bytes_[kHeader + i * (kFrameHeader + page_size_)];
    // Frames of another salt are left from before the log was begun anew.
    const bool is_of_this = std::equal(frame + 8, frame + 16, &bytes_[16]);
    const bool is_commit = wordAt(frame + 4) != 0;
    sum.add(frame, 8);
    sum.add(frame + kFrameHeader, page_size_);
    is_sound = is_sound && is_of_this && sum.isThatAt(frame + 16);
    if (is_commit && is_sound)
      end_ = kHeader + (i + 1) * (kFrameHeader + page_size_);
    else if (is_commit && is_of_this)
      ++lost_commits_;
  }
}

std::map<std::uint32_t, std::string_view>
WriteAheadLog::pages() const
{
  std::map<std::uint32_t, std::string_view> pages;
  if (page_size_ == 0)
    return pages;
  for (std::size_t at = kHeader; at < end_; at += kFrameHeader + page_size_)
    pages[wordAt(&bytes_[at])] = {
        reinterpret_cast<const char*>(&bytes_[at + kFrameHeader]), page_size_};
  return pages;
}

} // namespace pcl_semantic
