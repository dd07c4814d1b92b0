// SPDX-License-Identifier: BSD-3-Clause
#include "files/bytes.h"
#include "support/thrown_message.h"

#include <gtest/gtest.h>

using namespace pcl_semantic;

TEST(Bytes, AreReadAsTheyWereWritten)
{
  const std::vector<std::int16_t> column = {1, -2, 300};
  ByteWriter writer;
  writer.put(std::uint32_t(0x01020304));
  writer.putText("name");
  writer.putColumn(column);
  writer.putColumn(std::vector<float>{0.5f});
  writer.put(-1.25);
  writer.putBytes({7, 8});
  const Bytes& bytes = writer.bytes();
  EXPECT_EQ(bytes.size(), 4u + 4 + 4 + 6 + 4 + 8 + 2);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 5), (Bytes{4, 3, 2, 1, 4}))
      << "little-endian";
  ByteReader reader(bytes);
  EXPECT_EQ(reader.get<std::uint32_t>(), 0x01020304u);
  EXPECT_EQ(reader.getText(), "name");
  EXPECT_EQ(reader.getColumn<std::int16_t>(3), column);
  EXPECT_EQ(reader.get<float>(), 0.5f);
  EXPECT_EQ(reader.get<double>(), -1.25);
  EXPECT_EQ(reader.getRest(), (Bytes{7, 8}));
  expectBadInput("ends too early", [&] { reader.get<std::uint8_t>(); });
}
