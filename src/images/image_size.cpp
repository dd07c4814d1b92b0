// SPDX-License-Identifier: BSD-3-Clause
#include "image_size.h"

#include "files/bytes.h"

#include "core/fail.h"

#include <algorithm>

namespace pcl_semantic {

namespace {

// An integer of `size` bytes; 0 beyond the end.
std::uint64_t
number(const Bytes& bytes, std::size_t at, std::size_t size, bool is_little_endian)
{
  const bool is_there = at <= bytes.size() && size <= bytes.size() - at;
  return is_there ? wholeNumber(&bytes[at], size, !is_little_endian) : 0;
}

// From the chunk IHDR, which is first.
StatedSize
sizeOfPng(const Bytes& bytes)
{
  return {number(bytes, 16, 4, false), number(bytes, 20, 4, false)};
}

// From the segment "start of frame"; bytes between segments are ignored, as decoders
// do.
StatedSize
sizeOfJpeg(const Bytes& bytes)
{
  for (std::size_t at = 2; at + 1 < bytes.size();) {
    const std::uint8_t marker = bytes[at + 1];
    const bool has_content = marker >= 0xC0 && marker != 0xFF && marker != 0xD8 &&
                             !(marker >= 0xD0 && marker <= 0xD7);
    if (bytes[at] != 0xFF || !has_content) {
      ++at;
      continue;
    }
    if (marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC)
      return {number(bytes, at + 7, 2, false), number(bytes, at + 5, 2, false)};
    at += 2 + std::max<std::size_t>(number(bytes, at + 2, 2, false), 2);
  }
  return {};
}

// From the first directory of tags.
StatedSize
sizeOfTiff(const Bytes& bytes)
{
  constexpr std::uint64_t width = 256, length = 257; // tags
  constexpr std::size_t entry_size = 12;
  const bool little = bytes[0] == 'I';
  const std::size_t directory = number(bytes, 4, 4, little);
  const std::uint64_t entries = number(bytes, directory, 2, little);
  StatedSize size;
  for (std::uint64_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + i * entry_size;
    const std::uint64_t tag = number(bytes, entry, 2, little);
    if (tag != width && tag != length)
      continue;
    // Types 1 to 3 are bytes, text and 16 bits; the others have at least 32 bits.
    const std::uint64_t type = number(bytes, entry + 2, 2, little);
    const std::size_t value_size = type == 1 || type == 2 ? 1 : type == 3 ? 2 : 4;
    std::uint64_t& stated = tag == width ? size.columns : size.rows;
    stated = std::max(stated, number(bytes, entry + 8, value_size, little));
  }
  return size;
}

} // namespace

StatedSize
statedSize(const std::vector<std::uint8_t>& bytes)
{
  if (bytes.size() < 8)
    return {};
  switch (bytes[0]) {
  case 0x89:
    return sizeOfPng(bytes);
  case 0xFF:
    return sizeOfJpeg(bytes);
  default:
    return sizeOfTiff(bytes);
  }
}

void
requirePlausibleSize(const std::vector<std::uint8_t>& bytes, const std::string& path)
{
  constexpr std::uint64_t harmless = 100000000, most = 10000; // pixels in all, a byte
  const StatedSize size = statedSize(bytes);                  // of 32 bits each
  if (size.columns != 0 &&
      size.rows > std::max(harmless, most * bytes.size()) / size.columns)
    badInput(path, ": states ", size.columns, " x ", size.rows,
             " pixels, which do not fit into its ", bytes.size(), " bytes");
}

} // namespace pcl_semantic
