// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/printable.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string_view>

namespace pcl_semantic {

namespace {

// First UTF-8 character of a text; no bytes if it is invalid.
struct Character {
  std::size_t bytes = 0;
  std::uint32_t number = 0;
};

Character
firstOf(std::string_view text)
{
  const auto byte = [&](std::size_t i) { return std::uint8_t(text[i]); };
  if (byte(0) < 0x80)
    return {1, byte(0)};
  const std::size_t length = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || length > text.size())
    return {};
  std::uint32_t number = byte(0) & (0xFFu >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80)
      return {};
    number = number << 6 | (byte(i) & 0x3F);
  }
  constexpr std::uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_half = number >= 0xD800 && number < 0xE000; // UTF-16 surrogate
  if (number < smallest[length] || number > 0x10FFFF || is_half)
    return {};
  return {length, number};
}

// Control characters, and characters that change lines or their direction: they can
// make one name look like another.
bool
isHidden(std::uint32_t c)
{
  const auto isIn = [c](std::uint32_t first, std::uint32_t last) {
    return c >= first && c <= last;
  };
  return c < 0x20 || isIn(0x7F, 0x9F) || c == 0x61C || isIn(0x200E, 0x200F) ||
         isIn(0x2028, 0x202E) || isIn(0x2066, 0x2069);
}

} // namespace

std::string
printable(const std::string& text, bool keeps_lines)
{
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const Character first = firstOf(std::string_view(text).substr(i));
    const bool is_shown = !isHidden(first.number) || (keeps_lines && text[i] == '\n');
    const std::size_t length = is_shown ? first.bytes : 0;
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

std::string
printableJson(const std::string& json)
{
  std::string result;
  for (std::size_t i = 0; i < json.size();) {
    const Character first = firstOf(std::string_view(json).substr(i));
    const std::size_t length = std::max<std::size_t>(first.bytes, 1);
    if (first.bytes > 0 && json[i] != '\n' && isHidden(first.number)) {
      char escaped[8];
      std::snprintf(escaped, sizeof escaped, "\\u%04X", unsigned(first.number));
      result += escaped;
    }
    else
      result += json.substr(i, length);
    i += length;
  }
  return result;
}

} // namespace pcl_semantic
