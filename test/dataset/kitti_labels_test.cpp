// SPDX-License-Identifier: BSD-3-Clause
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/dataset/lidar_scan.h>

#include <fstream>
#include <limits>

namespace pcl_semantic {

namespace {

template <typename T>
void
writeArray(const std::string& path, const std::vector<T>& values, std::size_t bytes)
{
  std::ofstream stream(path, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(values.data()), std::streamsize(bytes));
}

} // namespace

TEST(VelodyneScan, ReadsPoints)
{
  const TemporaryFolder folder;
  writeArray<float>(folder.path("a.bin"), {1, 2, 3, 0.5f, -4, 5, -6, 0.25f}, 32);
  const auto scan = readVelodyneScan(folder.path("a.bin"));
  ASSERT_EQ(scan->size(), 2u);
  EXPECT_EQ((*scan)[1].x, -4.0f);
  EXPECT_EQ((*scan)[1].y, 5.0f);
  EXPECT_EQ((*scan)[1].z, -6.0f);
  EXPECT_EQ((*scan)[0].intensity, 0.5f);
}

TEST(VelodyneScan, RefusesDamagedFiles)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("a.bin");
  const auto read = [&] { readVelodyneScan(path); };
  expectBadInput("cannot be read", read);
  writeArray<float>(path, {}, 0);
  EXPECT_TRUE(readVelodyneScan(path)->empty());
  writeArray<float>(path, {1, 2, 3, 4, 5, 6, 7, 8}, 31);
  expectBadInput("has 31 bytes, expected a multiple of 16", read);
  writeArray<float>(path,
                    {1, 2, 3, 4, 5, std::numeric_limits<float>::quiet_NaN(), 7, 8}, 32);
  expectBadInput("point 1", read);
}

TEST(SemanticKittiLabels, MapsTheLower16Bits)
{
  LabelMapping mapping;
  mapping.set(40, 3);
  mapping.set(259, 6);
  const TemporaryFolder folder;
  writeArray<std::uint32_t>(folder.path("a.label"),
                            {40, 259u | 7u << 16, 41, 40u << 16}, 16);
  EXPECT_EQ(readSemanticKittiLabels(folder.path("a.label"), mapping, 4),
            (std::vector<Label>{3, 6, 0, 0}));
  expectBadInput("has 16 bytes, expected 20",
                 [&] { readSemanticKittiLabels(folder.path("a.label"), mapping, 5); });
  writeArray<std::uint32_t>(folder.path("a.label"), {40, 40}, 7);
  expectBadInput("has 7 bytes, expected 8",
                 [&] { readSemanticKittiLabels(folder.path("a.label"), mapping, 2); });
}

TEST(ScanLabels, ComeBackAsWritten)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("a.label");
  writeScanLabels(path, {0, 3, 11, 1});
  EXPECT_EQ(bytesOf(path), std::string("\0\0\0\0\3\0\0\0\13\0\0\0\1\0\0\0", 16));
  EXPECT_EQ(readScanLabels(path, 11), (std::vector<Label>{0, 3, 11, 1}));
  expectBadInput("point 2 has class 11, expected 0 to 10",
                 [&] { readScanLabels(path, 10); });
  writeArray<std::uint32_t>(path, {7 | 5u << 16, 2}, 8); // an instance above the class
  EXPECT_EQ(readScanLabels(path, 11), (std::vector<Label>{7, 2}));
  writeArray<std::uint32_t>(path, {1, 2}, 7);
  expectBadInput("has 7 bytes", [&] { readScanLabels(path, 11); });
}

TEST(ScanNumbers, HaveClassAndObject)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("a.label");
  writeArray<std::uint32_t>(path, {40, 259u | 65535u << 16}, 8);
  EXPECT_EQ(readScanNumbers(path),
            (std::vector<std::uint32_t>{40, 259u | 65535u << 16}));
  writeArray<std::uint32_t>(path, {1, 2}, 7);
  expectBadInput("a.label: has 7 bytes", [&] { readScanNumbers(path); });
}

TEST(FrameRange, HalfOpen)
{
  const FrameRange range = parseFrameRange("3:7");
  EXPECT_FALSE(range.contains(2));
  EXPECT_TRUE(range.contains(3));
  EXPECT_TRUE(range.contains(6));
  EXPECT_FALSE(range.contains(7));
  EXPECT_TRUE(parseFrameRange(":").contains(1000000));
  EXPECT_FALSE(parseFrameRange(":5").contains(5));
  EXPECT_TRUE(parseFrameRange("5:").contains(5));
  for (const char* text :
       {"", "5", "10:5", "5:5", "-1:5", "a:b", "1:2:3", "1.5:2", "1: 2"})
    EXPECT_THROW(parseFrameRange(text), InvalidParameterException) << text;
}

} // namespace pcl_semantic
