// SPDX-License-Identifier: BSD-3-Clause
#include "images/image_size.h"

#include <gtest/gtest.h>

using namespace pcl_semantic;

namespace {

// A directory of two tags, each with one value of 16 bits; behind that is anything.
std::vector<std::uint8_t>
tiff(bool little)
{
  std::vector<std::uint8_t> bytes;
  const auto put = [&](std::uint32_t value, int size) {
    for (int b = 0; b < size; ++b)
      bytes.push_back(std::uint8_t(value >> 8 * (little ? b : size - 1 - b)));
  };
  bytes.assign(2, little ? 'I' : 'M');
  put(42, 2);
  put(8, 4);
  put(2, 2);
  for (const auto& [tag, value] : {std::pair(256, 1241), std::pair(257, 376)}) {
    put(std::uint32_t(tag), 2);
    put(3, 2);
    put(1, 4);
    put(std::uint32_t(value), 2);
    put(0xABCD, 2);
  }
  return bytes;
}

} // namespace

TEST(StatedSize, OfTiffIsReadInBothOrdersOfBytes)
{
  for (const bool little : {true, false}) {
    std::vector<std::uint8_t> bytes = tiff(little);
    EXPECT_EQ(statedSize(bytes).columns, 1241u) << little;
    EXPECT_EQ(statedSize(bytes).rows, 376u) << little;
    for (; !bytes.empty(); bytes.pop_back())
      EXPECT_LE(statedSize(bytes).columns, 1241u) << bytes.size();
  }
}
