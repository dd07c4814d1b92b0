// SPDX-License-Identifier: BSD-3-Clause
#include "support/refused_file.h"
#include "support/same_image.h"

#include <pcl_semantic/images/image_file.h>

#include <boost/crc.hpp>
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
encoded(const std::string& extension, const cv::Mat& image,
        const std::vector<int>& parameters = {})
{
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(extension, image, bytes, parameters));
  return {bytes.begin(), bytes.end()};
}

std::string
bigEndian(std::uint32_t value)
{
  return {char(value >> 24), char(value >> 16), char(value >> 8), char(value)};
}

std::uint32_t
crc32(const std::string& bytes)
{
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

::testing::AssertionResult
refuses(const std::string& bytes, ImageKind kind = ImageKind::grey_or_colour,
        const std::string& part = "")
{
  return refusesFile("a.png", bytes, part,
                     [&](const std::string& path) { readPng(path, kind); });
}

::testing::AssertionResult
refusesImage(const std::string& name, const std::string& bytes, const std::string& part)
{
  return refusesFile(name, bytes, part,
                     [](const std::string& path) { readImage(path); });
}

} // namespace

TEST(ReadPng, ReadsWhatWritePngWrote)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("a.png");
  for (const auto& [type, kind] : {std::pair(CV_8UC1, ImageKind::grey_or_colour),
                                   std::pair(CV_8UC3, ImageKind::grey_or_colour),
                                   std::pair(CV_8UC1, ImageKind::labels),
                                   std::pair(CV_16UC1, ImageKind::disparity)}) {
    const cv::Mat image = randomImage(17, 31, type);
    writePng(path, image);
    EXPECT_TRUE(isSameImage(readPng(path, kind), image)) << type;
  }
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(ReadPng, RefusesOtherKinds)
{
  for (const auto& [type, kind] :
       {std::pair(CV_16UC1, ImageKind::grey_or_colour),
        std::pair(CV_16UC3, ImageKind::grey_or_colour),
        std::pair(CV_8UC4, ImageKind::grey_or_colour),
        std::pair(CV_8UC3, ImageKind::labels), std::pair(CV_16UC1, ImageKind::labels),
        std::pair(CV_8UC1, ImageKind::disparity)})
    EXPECT_TRUE(refuses(encoded(".png", randomImage(9, 8, type)), kind)) << type;
}

// Decoders stretch fewer bits to 0..255: class 1 would silently become 255.
TEST(ReadPng, RefusesLabelsOfFewerThanEightBits)
{
  const std::string bytes =
      encoded(".png", randomImage(9, 8, CV_8UC1) & 1, {cv::IMWRITE_PNG_BILEVEL, 1});
  const std::vector<char> copy(bytes.begin(), bytes.end());
  ASSERT_EQ(cv::imdecode(copy, cv::IMREAD_UNCHANGED).type(), CV_8UC1);
  EXPECT_TRUE(refuses(bytes, ImageKind::labels, "1 bit"));
}

TEST(ReadPng, RefusesEveryTruncationHoleAndFlippedBit)
{
  const std::string whole = encoded(".png", randomImage(40, 50, CV_8UC3));
  for (std::size_t size = 0; size < whole.size(); size += size < 100 ? 1 : 61)
    EXPECT_TRUE(refuses(whole.substr(0, size))) << size;
  for (std::size_t at = 45; at + 200 < whole.size(); at += 97) {
    std::string hole = whole, flipped = whole;
    EXPECT_TRUE(refuses(hole.erase(at, 100))) << at;
    flipped[at] = char(flipped[at] ^ 4);
    EXPECT_TRUE(refuses(flipped)) << at;
  }
}

TEST(ReadPng, RefusesWhatIsNoPng)
{
  EXPECT_TRUE(refuses(std::string(1000, '\0')));
  for (const char* const extension : {".jpg", ".bmp"})
    EXPECT_TRUE(refuses(encoded(extension, randomImage(20, 20, CV_8UC3))));
  thrownMessage<BadInputException>([] { readPng("/missing.png", ImageKind::labels); });
}

TEST(ReadPng, RefusesSizesThatAreNoCameraImage)
{
  for (const auto& [rows, columns] :
       {std::pair(1, 1), std::pair(9, 1), std::pair(1, 9)})
    EXPECT_TRUE(refuses(encoded(".png", randomImage(rows, columns, CV_8UC1)),
                        ImageKind::labels));
  // A header that promises a million rows and columns, with a valid checksum.
  std::string bytes = encoded(".png", randomImage(9, 9, CV_8UC1));
  bytes.replace(16, 8, bigEndian(1000000) + bigEndian(1000000));
  bytes.replace(29, 4, bigEndian(crc32(bytes.substr(12, 17))));
  EXPECT_TRUE(refuses(bytes, ImageKind::labels));
}

TEST(WritePng, LeavesNothingBehindWhenItFails)
{
  const TemporaryFolder folder;
  thrownMessage<OutputException>([&] { writePng(folder.path("a.png"), cv::Mat()); });
  thrownMessage<OutputException>(
      [&] { writePng(folder.path("none/a.png"), cv::Mat::ones(4, 4, CV_8UC3)); });
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(ReadImage, ATiffIsReadOrRefusedWithAWord)
{
  const TemporaryFolder folder;
  const cv::Mat image = randomImage(48, 64, CV_8UC3);
  const std::string whole = encoded(".tiff", image);
  EXPECT_TRUE(isSameImage(readImage(folder.write("a.tif", whole)), image));
  for (std::size_t size = 0; size < whole.size(); size += 1 + whole.size() / 50)
    EXPECT_TRUE(refusesImage("a.tif", whole.substr(0, size), "TIFF image")) << size;
  EXPECT_TRUE(
      refusesImage("a.tif", encoded(".tiff", cv::Mat(48, 64, CV_16UC1, 1000.0)),
                   "has 1 channel(s) of 16 bits, expected 8-bit grey or 8-bit RGB"));
}

// OpenCV gives the colours of a palette, not its indices, which are the classes.
TEST(ReadPng, RefusesClassesInAPalette)
{
  const char bytes[] =
      "\x89\x50\x4E\x47\x0D\x0A\x1A\x0A\x00\x00\x00\x0D\x49\x48\x44\x52\x00\x00"
      "\x00\x02\x00\x00\x00\x02\x08\x03\x00\x00\x00\x45\x68\xFD\x16\x00\x00\x00"
      "\x06\x50\x4C\x54\x45\x00\x00\x00\x80\x00\x00\x44\x52\xA2\x4F\x00\x00\x00"
      "\x0C\x49\x44\x41\x54\x78\x9C\x63\x60\x60\x04\x42\x00\x00\x0C\x00\x03\x2B"
      "\x63\xCB\x50\x00\x00\x00\x00\x49\x45\x4E\x44\xAE\x42\x60\x82";
  const TemporaryFolder folder;
  const std::string path = folder.write("a.png", {bytes, sizeof bytes - 1});
  EXPECT_EQ(readPng(path, ImageKind::grey_or_colour).channels(), 3);
  const std::string message =
      thrownMessage<BadInputException>([&] { readPng(path, ImageKind::labels); });
  EXPECT_TRUE(holds(message, "has a palette, expected"));
}

// OpenCV looks for formats one after the other, and one of its decoders aborts.
TEST(ReadImage, TakesNothingElseForAJpeg)
{
  std::string dicom(128, '\xC7');
  dicom.replace(0, 4, std::string("\xFF\xD8\x8C\0", 4));
  EXPECT_TRUE(
      refusesImage("a.jpg", dicom + "DICM\xFF\xD9", "a.jpg: is not a JPEG image"));
}

// Of a few bytes that promise many pixels no memory is taken.
TEST(ReadImage, RefusesMorePixelsThanTheFileCanHold)
{
  const cv::Mat image = randomImage(48, 64, CV_8UC3);
  std::string png = encoded(".png", image);
  png.replace(16, 8, bigEndian(50000) + bigEndian(40000));
  png.replace(29, 4, bigEndian(crc32(png.substr(12, 17))));
  std::string jpeg = encoded(".jpg", image);
  jpeg.replace(jpeg.find("\xFF\xC0") + 5, 4, bigEndian(40000u << 16 | 50000u));
  std::string tiff = encoded(".tif", image);
  ASSERT_EQ(tiff[0], 'I');
  const auto setTag = [&](const std::string& tag, std::uint32_t value) {
    const std::size_t entry = tiff.find(tag);
    ASSERT_NE(entry, std::string::npos);
    const std::string big = bigEndian(value);
    tiff.replace(entry + 8, 4, std::string(big.rbegin(), big.rend()));
    tiff.replace(entry + 2, 2, std::string("\4\0", 2)); // 32 bits
  };
  using namespace std::string_literals;
  setTag("\x00\x01\x03\x00\x01\x00"s, 50000);
  setTag("\x01\x01\x03\x00\x01\x00"s, 40000);
  for (const auto& [name, bytes] :
       {std::pair("a.png", png), std::pair("a.jpg", jpeg), std::pair("a.tif", tiff)})
    EXPECT_TRUE(
        refusesImage(name, bytes, "states 50000 x 40000 pixels, which do not fit"));
}
