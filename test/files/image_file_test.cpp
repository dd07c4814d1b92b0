// SPDX-License-Identifier: BSD-3-Clause
#include "support/full_disk.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/image_file.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

using namespace pcl_semantic;

namespace {

cv::Mat
randomImage(int rows, int columns, int type)
{
  cv::Mat image(rows, columns, type);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, CV_MAT_DEPTH(type) == CV_16U ? 65536 : 256);
  return image;
}

std::string
encoded(const std::string& extension, const cv::Mat& image)
{
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(extension, image, bytes));
  return {bytes.begin(), bytes.end()};
}

bool
equal(const cv::Mat& a, const cv::Mat& b)
{
  return a.size() == b.size() && a.type() == b.type() &&
         cv::norm(a.reshape(1), b.reshape(1), cv::NORM_INF) == 0.0;
}

std::string
bigEndian(std::uint32_t value)
{
  return {char(value >> 24), char(value >> 16), char(value >> 8), char(value)};
}

std::uint32_t
crc32(const std::string& bytes)
{
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char byte : bytes) {
    crc ^= static_cast<std::uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit)
      crc = crc >> 1 ^ (crc & 1u ? 0xEDB88320u : 0u);
  }
  return ~crc;
}

} // namespace

TEST(ReadPng, ReadsWhatWritePngWrote)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("a.png");
  const std::pair<int, ImageKind> cases[] = {{CV_8UC1, ImageKind::grey_or_colour},
                                             {CV_8UC3, ImageKind::grey_or_colour},
                                             {CV_8UC1, ImageKind::labels},
                                             {CV_16UC1, ImageKind::disparity}};
  for (const auto& [type, kind] : cases) {
    const cv::Mat image = randomImage(17, 31, type);
    writePng(path, image);
    EXPECT_TRUE(equal(readPng(path, kind), image)) << type;
  }
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(ReadPng, RefusesOtherKinds)
{
  const TemporaryFolder folder;
  const std::pair<int, ImageKind> cases[] = {
      {CV_16UC1, ImageKind::grey_or_colour}, {CV_16UC3, ImageKind::grey_or_colour},
      {CV_8UC4, ImageKind::grey_or_colour},  {CV_8UC3, ImageKind::labels},
      {CV_16UC1, ImageKind::labels},         {CV_8UC1, ImageKind::disparity}};
  for (const auto& [type, kind] : cases) {
    const std::string path =
        folder.write("a.png", encoded(".png", randomImage(9, 8, type)));
    EXPECT_TRUE(holds(
        thrownMessage<BadInputException>([&, k = kind] { readPng(path, k); }), path))
        << type;
  }
}

// Decoders stretch fewer bits to 0..255: class 1 would silently become 255.
TEST(ReadPng, RefusesLabelsOfFewerThanEightBits)
{
  const TemporaryFolder folder;
  const cv::Mat ids = randomImage(9, 8, CV_8UC1) & 1;
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(cv::imencode(".png", ids, bytes, {cv::IMWRITE_PNG_BILEVEL, 1}));
  ASSERT_EQ(cv::imdecode(bytes, cv::IMREAD_UNCHANGED).type(), CV_8UC1);
  const std::string path = folder.write("a.png", {bytes.begin(), bytes.end()});
  EXPECT_TRUE(
      holds(thrownMessage<BadInputException>([&] { readPng(path, ImageKind::labels); }),
            "1 bit"));
}

TEST(ReadPng, RefusesEveryTruncation)
{
  const TemporaryFolder folder;
  const std::string whole = encoded(".png", randomImage(40, 50, CV_8UC3));
  for (std::size_t size = 0; size < whole.size(); size += size < 100 ? 1 : 61) {
    const std::string path = folder.write("a.png", whole.substr(0, size));
    EXPECT_TRUE(holds(thrownMessage<BadInputException>(
                          [&] { readPng(path, ImageKind::grey_or_colour); }),
                      path))
        << size;
  }
}

TEST(ReadPng, RefusesAFileWithAHoleAndAFlippedBit)
{
  const TemporaryFolder folder;
  const std::string whole = encoded(".png", randomImage(40, 50, CV_8UC3));
  for (std::size_t at = 45; at + 200 < whole.size(); at += 97) {
    std::string hole = whole;
    hole.erase(at, 100);
    std::string path = folder.write("hole.png", hole);
    thrownMessage<BadInputException>([&] { readPng(path, ImageKind::grey_or_colour); });
    std::string flipped = whole;
    flipped[at] = char(flipped[at] ^ 4);
    path = folder.write("flipped.png", flipped);
    thrownMessage<BadInputException>([&] { readPng(path, ImageKind::grey_or_colour); });
  }
}

TEST(ReadPng, RefusesWhatIsNoPng)
{
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& bytes) {
    const std::string path = folder.write("a.png", bytes);
    return holds(thrownMessage<BadInputException>(
                     [&] { readPng(path, ImageKind::grey_or_colour); }),
                 path);
  };
  EXPECT_TRUE(refused(""));
  EXPECT_TRUE(refused(std::string(1000, '\0')));
  EXPECT_TRUE(refused(encoded(".jpg", randomImage(20, 20, CV_8UC3))));
  EXPECT_TRUE(refused(encoded(".bmp", randomImage(20, 20, CV_8UC3))));
  thrownMessage<BadInputException>(
      [&] { readPng(folder.path("missing.png"), ImageKind::labels); });
}

TEST(ReadPng, RefusesSizesThatAreNoCameraImage)
{
  const TemporaryFolder folder;
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 9), cv::Size(9, 1)}) {
    const std::string path = folder.write(
        "a.png", encoded(".png", randomImage(size.height, size.width, CV_8UC1)));
    thrownMessage<BadInputException>([&] { readPng(path, ImageKind::labels); });
  }
  // A header that promises a million rows and columns, with a valid check sum.
  std::string bytes = encoded(".png", randomImage(9, 9, CV_8UC1));
  bytes.replace(16, 8, bigEndian(1000000) + bigEndian(1000000));
  bytes.replace(29, 4, bigEndian(crc32(bytes.substr(12, 17))));
  const std::string path = folder.write("a.png", bytes);
  thrownMessage<BadInputException>([&] { readPng(path, ImageKind::labels); });
}

TEST(WritePng, LeavesNothingBehindWhenItFails)
{
  const TemporaryFolder folder;
  {
    const FullDisk full(1000);
    thrownMessage<OutputException>(
        [&] { writePng(folder.path("a.png"), randomImage(100, 100, CV_8UC3)); });
  }
  thrownMessage<OutputException>([&] { writePng(folder.path("a.png"), cv::Mat()); });
  EXPECT_EQ(folder.entries(), 0u);
}
TEST(ReadImage, ATiffIsReadOrRefusedWithAWord)
{
  const TemporaryFolder folder;
  cv::Mat image(48, 64, CV_8UC3);
  cv::RNG(1).fill(image, cv::RNG::UNIFORM, 0, 256);
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(cv::imencode(".tiff", image, bytes));
  const auto write = [&](std::size_t size) {
    return folder.write(
        "a.tif", std::string(bytes.begin(), bytes.begin() + std::ptrdiff_t(size)));
  };
  EXPECT_EQ(cv::norm(readImage(write(bytes.size())), image, cv::NORM_INF), 0.0);
  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 50)
    EXPECT_TRUE(holds(thrownMessage<BadInputException>([&] { readImage(write(size)); }),
                      "TIFF image"))
        << size;
  cv::Mat deep(48, 64, CV_16UC1, cv::Scalar(1000));
  ASSERT_TRUE(cv::imencode(".tiff", deep, bytes));
  EXPECT_TRUE(
      holds(thrownMessage<BadInputException>([&] { readImage(write(bytes.size())); }),
            "has 1 channel(s) of 16 bits, expected 8-bit grey or 8-bit RGB"));
}
