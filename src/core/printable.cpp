// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/printable.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string_view>

namespace pcl_semantic {

namespace {

// Bytes of the UTF-8 character at the beginning; 0 if there is none, or a control one.
std::size_t
lengthOfPrintable(std::string_view text)
{
  const auto byte = [&](std::size_t i) { return std::uint8_t(text[i]); };
  if (byte(0) < 0x80)
    return byte(0) >= 0x20 && byte(0) != 0x7F ? 1 : 0;
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || length > text.size())
    return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80)
      return 0;
  return byte(0) == 0xC2 && byte(1) < 0xA0 ? 0 : length; // C1 controls
}

} // namespace

std::string
printable(const std::string& text, bool keeps_lines)
{
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t length = lengthOfPrintable(std::string_view(text).substr(i));
    if (keeps_lines && text[i] == '\n')
      length = 1;
    if (length > 0)
      result += text.substr(i, length);
    else {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\x%02X",
                    unsigned(std::uint8_t(text[i])));
      result += escaped;
    }
    i += std::max<std::size_t>(length, 1);
  }
  return result;
}

} // namespace pcl_semantic
