// SPDX-License-Identifier: BSD-3-Clause
#include "support/refused_file.h"

#include <pcl_semantic/files/npy_file.h>

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <random>

using namespace pcl_semantic;

namespace {

// An .npy file of version 1 as NumPy writes it, padded to 64 bytes.
std::string
npy(const std::string& type, const std::string& shape, const std::string& data,
    const std::string& order = "False")
{
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + order +
                       ", 'shape': " + shape + ", }";
  header.append(64 - (10 + header.size() + 1) % 64, ' ');
  header += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + char(header.size() & 255) +
         char(header.size() >> 8) + header + data;
}

std::string
floats(int count)
{
  std::string data(std::size_t(count) * 4, '\0');
  for (int i = 0; i < count; ++i) {
    const float value = 0.25f * float(i) - 1.0f;
    std::memcpy(data.data() + 4 * i, &value, 4);
  }
  return data;
}

// The values in the order of the file.
std::vector<float>
listOf(const NpyArray& array)
{
  return {array.values.data(), array.values.data() + array.values.size()};
}

::testing::AssertionResult
refuses(const std::string& bytes, const std::string& part = "")
{
  return refusesFile("a.npy", bytes, part,
                     [](const std::string& path) { return readNpy(path); });
}

} // namespace

TEST(ReadNpy, ReadsFloat16)
{
  const TemporaryFolder folder;
  // 1, -2, 0.5, 65504, the smallest subnormal, 1/3 rounded
  const std::uint16_t halves[] = {0x3C00, 0xC000, 0x3800, 0x7BFF, 0x0001, 0x3555};
  const std::string data(reinterpret_cast<const char*>(halves), sizeof(halves));
  const NpyArray array = readNpy(folder.write("a.npy", npy("<f2", "(1, 2, 3)", data)));
  EXPECT_EQ(listOf(array), (std::vector<float>{1.0f, -2.0f, 0.5f, 65504.0f,
                                               5.9604645e-8f, 0.33325195f}));
}

TEST(ReadNpy, RefusesWhatDiffersAndSizesThatDoNotFitTheFile)
{
  EXPECT_TRUE(refuses(npy("<f8", "(2, 3, 4)", floats(48)), "<f8"));
  EXPECT_TRUE(refuses(npy(">f4", "(2, 3, 4)", floats(24)), ">f4"));
  EXPECT_TRUE(refuses(npy("<f4", "(2, 3, 4)", floats(24), "True"), "Fortran"));
  for (const char* const shape :
       {"(24,)", "(6, 4)", "(1, 2, 3, 4)", "()", "(-2, 3, 4)"})
    EXPECT_TRUE(refuses(npy("<f4", shape, floats(24)), "three axes"));
  const std::string whole = npy("<f4", "(2, 3, 4)", floats(24));
  EXPECT_TRUE(refuses(whole + "x"));
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_TRUE(refuses(whole.substr(0, size)));
  for (const char* const shape :
       {"(2147483648, 2147483648, 4)", "(999999, 999999, 999999)",
        "(99999999999999999999, 1, 1)"})
    EXPECT_TRUE(refuses(npy("<f4", shape, floats(24))));
  // A header of another length or version.
  std::string bytes = whole;
  bytes[8] = bytes[9] = '\xFF';
  EXPECT_TRUE(refuses(bytes));
  bytes[6] = '\x02';
  bytes[10] = bytes[11] = '\xFF';
  EXPECT_TRUE(refuses(bytes));
  bytes[6] = '\x07';
  EXPECT_TRUE(refuses(bytes, "version 7"));
  // A header of 4 MB, 0x3D090C bytes, must not exhaust the stack.
  EXPECT_TRUE(refuses(std::string("\x93NUMPY\x02\x00\x0C\x09\x3D\x00", 12) +
                      "{'descr': '" + std::string(4000000, 'f')));
}

TEST(WriteNpy, IsTheFileThatNumPyWrites)
{
  const TemporaryFolder folder;
  const std::string data = floats(24);
  std::vector<float> values(24);
  std::memcpy(values.data(), data.data(), data.size());
  writeNpy(folder.path("a.npy"), 2, 3, 4, values.data(), NpyType::float32);
  const std::string bytes = bytesOf(folder.path("a.npy"));
  EXPECT_EQ(bytes.substr(0, 10), std::string("\x93NUMPY\x01\x00\x76\x00", 10));
  const std::string header =
      "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 4), }";
  EXPECT_EQ(bytes.substr(10, header.size()), header);
  EXPECT_EQ(bytes[127], '\n');
  EXPECT_EQ(bytes.substr(128), data);
  const NpyArray array = readNpy(folder.path("a.npy"));
  EXPECT_EQ(listOf(array), values);
  EXPECT_EQ(array.height, 2);
  EXPECT_EQ(array.width, 3);
  EXPECT_EQ(array.depth, 4);
  // NumPy's own padding
  const std::string other = folder.write("b.npy", npy("<f4", "(2, 3, 4)", data));
  EXPECT_EQ(listOf(readNpy(other)), values);
}

TEST(WriteNpy, HalfFloatsAreRoundedTo11Bits)
{
  const TemporaryFolder folder;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(1e-4f, 1.0f);
  std::vector<float> values(60);
  for (float& value : values)
    value = uniform(random);
  writeNpy(folder.path("a.npy"), 3, 4, 5, values.data(), NpyType::float16);
  EXPECT_EQ(std::filesystem::file_size(folder.path("a.npy")), 128u + 2 * 60);
  const NpyArray array = readNpy(folder.path("a.npy"));
  const std::vector<float> found = listOf(array);
  ASSERT_EQ(found.size(), values.size());
  EXPECT_EQ(array.height, 3);
  EXPECT_EQ(array.width, 4);
  bool rounded = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(found[i], values[i], values[i] / 2048.0f);
    rounded = rounded || found[i] != values[i];
  }
  EXPECT_TRUE(rounded);
}
