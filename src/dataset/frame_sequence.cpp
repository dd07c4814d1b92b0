// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/dataset/frame_sequence.h>

#include "core/fail.h"

#include <charconv>

namespace pcl_semantic {

namespace {

bool
parseFrame(const std::string& text, int& frame)
{
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, frame);
  return text.empty() || (error == std::errc() && rest == end && frame >= 0);
}

} // namespace

FrameRange
parseFrameRange(const std::string& text)
{
  FrameRange range;
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos || !parseFrame(text.substr(0, colon), range.first) ||
      !parseFrame(text.substr(colon + 1), range.end) || range.first >= range.end)
    fail<InvalidParameterException>(
        "frames '", text, "': expected A:B with 0 <= A < B (frames A to B - 1)");
  return range;
}

} // namespace pcl_semantic
