// SPDX-License-Identifier: BSD-3-Clause
#include "quiet_opencv.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <filesystem>

namespace pcl_semantic {

void
writeSmallPng(const std::string& path, const cv::Mat& picture)
{
  if (picture.type() != CV_8UC3)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        path << ": a picture has three colours of 8 bits");
  cv::Mat table(1, 256, CV_8UC1), coarse;
  for (int value = 0; value < 256; ++value)
    table.at<std::uint8_t>(0, value) =
        static_cast<std::uint8_t>(std::min(255, (value + 4) / 8 * 8));
  cv::LUT(picture, table, coarse);
  std::vector<std::uint8_t> bytes;
  const std::vector<int> parameters = {cv::IMWRITE_PNG_COMPRESSION, 9,
                                       cv::IMWRITE_PNG_STRATEGY,
                                       cv::IMWRITE_PNG_STRATEGY_DEFAULT};
  if (!cv::imencode(".png", coarse, bytes, parameters))
    PCL_THROW_EXCEPTION(OutputException, path << ": cannot be encoded as PNG");
  AtomicFile file(path);
  file.stream().write(reinterpret_cast<const char*>(bytes.data()),
                      std::streamsize(bytes.size()));
  file.commit();
}

namespace {

constexpr std::uint8_t signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t chunk_frame = 12; // length, name and check sum around the data

std::uint32_t
bigEndian(const std::uint8_t* bytes)
{
  return std::uint32_t(bytes[0]) << 24 | std::uint32_t(bytes[1]) << 16 |
         std::uint32_t(bytes[2]) << 8 | std::uint32_t(bytes[3]);
}

std::array<std::uint32_t, 256>
makeCrcTable()
{
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit)
      table[i] = table[i] >> 1 ^ (table[i] & 1u ? 0xEDB88320u : 0u);
  }
  return table;
}

std::uint32_t
crc32(const std::uint8_t* bytes, std::size_t size)
{
  static const std::array<std::uint32_t, 256> table = makeCrcTable();
  std::uint32_t crc = 0xFFFFFFFFu;
  for (std::size_t i = 0; i < size; ++i)
    crc = crc >> 8 ^ table[(crc ^ bytes[i]) & 255u];
  return ~crc;
}

// Follows the chunks to the last one: OpenCV would print libpng's complaint about a
// damaged file, and keep the rows above the damage of some.
bool
isWhole(const std::vector<std::uint8_t>& bytes)
{
  std::size_t at = sizeof(signature);
  while (at + chunk_frame <= bytes.size()) {
    const std::size_t length = bigEndian(&bytes[at]);
    if (length > bytes.size() - at - chunk_frame ||
        crc32(&bytes[at + 4], length + 4) != bigEndian(&bytes[at + 8 + length]))
      return false;
    const bool is_last = std::equal(&bytes[at + 4], &bytes[at + 8], "IEND");
    at += chunk_frame + length;
    if (is_last)
      return at == bytes.size();
  }
  return false;
}

bool
hasKind(const cv::Mat& image, ImageKind kind)
{
  switch (kind) {
  case ImageKind::grey_or_colour:
    return image.type() == CV_8UC1 || image.type() == CV_8UC3;
  case ImageKind::labels:
    return image.type() == CV_8UC1;
  case ImageKind::segments:
    return image.type() == CV_8UC1 || image.type() == CV_16UC1;
  case ImageKind::disparity:
    return image.type() == CV_16UC1;
  }
  return false;
}

const char*
describe(ImageKind kind)
{
  switch (kind) {
  case ImageKind::grey_or_colour:
    return "8-bit grey or 8-bit RGB";
  case ImageKind::labels:
    return "8-bit grey (class ids)";
  case ImageKind::segments:
    return "8-bit or 16-bit grey (numbers of segments)";
  case ImageKind::disparity:
    return "16-bit grey (256 x disparity)";
  }
  return "";
}

} // namespace

const std::vector<std::string>&
imageExtensions()
{
  static const std::vector<std::string> extensions{".png", ".jpg", ".jpeg", ".tif",
                                                   ".tiff"};
  return extensions;
}

namespace {

// Of one that is cut off OpenCV would print a complaint and make up the rest.
void
requireWholeJpeg(const std::vector<std::uint8_t>& bytes, const std::string& path)
{
  if (bytes.size() < 4 || bytes[0] != 0xFF || bytes[1] != 0xD8)
    PCL_THROW_EXCEPTION(BadInputException, path << ": is not a JPEG image");
  std::size_t end = bytes.size();
  while (end > 2 && bytes[end - 1] == 0)
    --end;
  if (bytes[end - 2] != 0xFF || bytes[end - 1] != 0xD9)
    PCL_THROW_EXCEPTION(BadInputException, path << ": the JPEG image is not complete");
}

void
requireTiff(const std::vector<std::uint8_t>& bytes, const std::string& path)
{
  const std::uint8_t little[] = {'I', 'I', 42, 0}, big[] = {'M', 'M', 0, 42};
  if (bytes.size() < 8 || (!std::equal(little, little + 4, bytes.begin()) &&
                           !std::equal(big, big + 4, bytes.begin())))
    PCL_THROW_EXCEPTION(BadInputException, path << ": is not a TIFF image");
}

} // namespace

cv::Mat
readImage(const std::string& path)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  const bool is_jpeg = extension == ".jpg" || extension == ".jpeg";
  if (!is_jpeg && extension != ".tif" && extension != ".tiff")
    return readPng(path, ImageKind::grey_or_colour);
  const std::vector<std::uint8_t> bytes = readBytes(path);
  const char* const name = is_jpeg ? "JPEG" : "TIFF";
  if (is_jpeg)
    requireWholeJpeg(bytes, path);
  else
    requireTiff(bytes, path);
  cv::Mat image;
  try {
    const QuietOpenCv quiet;
    image = cv::imdecode(bytes,
                         is_jpeg ? cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION
                                 : cv::IMREAD_UNCHANGED);
  }
  catch (const cv::Exception&) { // damaged, or larger than OpenCV's limit
  }
  if (image.cols < 2 || image.rows < 2)
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": the " << name << " image is damaged");
  if (!hasKind(image, ImageKind::grey_or_colour))
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": has " << image.channels() << " channel(s) of "
                             << 8 * image.elemSize1() << " bits, expected "
                             << describe(ImageKind::grey_or_colour));
  return image;
}

cv::Mat
readPng(const std::string& path, ImageKind kind)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  constexpr std::size_t bit_depth = 24; // where the header chunk holds it
  if (bytes.size() <= bit_depth ||
      !std::equal(std::begin(signature), std::end(signature), bytes.begin()))
    PCL_THROW_EXCEPTION(BadInputException, path << ": is not a PNG image");
  if (!isWhole(bytes))
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": the PNG image is damaged or not complete");
  // Decoders stretch fewer bits to 0..255, which makes other class ids of them.
  if ((kind == ImageKind::labels || kind == ImageKind::segments) &&
      bytes[bit_depth] < 8)
    PCL_THROW_EXCEPTION(BadInputException, path << ": has " << int(bytes[bit_depth])
                                                << " bit(s) a pixel, expected "
                                                << describe(kind));
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  }
  catch (const cv::Exception&) { // an image larger than OpenCV's limit
  }
  if (image.empty())
    PCL_THROW_EXCEPTION(BadInputException, path << ": the PNG image is damaged");
  if (!hasKind(image, kind))
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": has " << image.channels() << " channel(s) of "
                             << 8 * image.elemSize1() << " bits, expected "
                             << describe(kind));
  if (image.cols < 2 || image.rows < 2)
    PCL_THROW_EXCEPTION(BadInputException, path << ": is only " << image.cols << " x "
                                                << image.rows << " pixels");
  return image;
}

void
writePng(const std::string& path, const cv::Mat& image)
{
  std::vector<std::uint8_t> bytes;
  if (image.empty() || !cv::imencode(".png", image, bytes))
    PCL_THROW_EXCEPTION(OutputException, path << ": cannot be encoded as PNG");
  AtomicFile file(path);
  file.stream().write(reinterpret_cast<const char*>(bytes.data()),
                      std::streamsize(bytes.size()));
  file.commit();
}

} // namespace pcl_semantic
