// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/images/image_file.h>

#include "files/bytes.h"
#include "image_size.h"
#include "opencv_settings.h"

#include "core/fail.h"

#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>

#include <boost/algorithm/string/case_conv.hpp>
#include <boost/crc.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <filesystem>

namespace pcl_semantic {

namespace {

bool
beginsWith(const Bytes& bytes, std::initializer_list<std::uint8_t> signature)
{
  return bytes.size() >= signature.size() &&
         std::equal(signature.begin(), signature.end(), bytes.begin());
}

std::uint32_t
crc32(const std::uint8_t* bytes, std::size_t size)
{
  boost::crc_32_type crc;
  crc.process_bytes(bytes, size);
  return crc.checksum();
}

// Follows the chunks of a PNG image to the last one. OpenCV would print libpng's
// message about a damaged file, and keep the rows above the damage in some cases.
bool
isWhole(const Bytes& bytes)
{
  constexpr std::size_t frame = 12; // length, name and checksum around the data
  std::size_t at = 8;               // after the signature
  while (at + frame <= bytes.size()) {
    const std::size_t length = wholeNumber(&bytes[at], 4);
    if (length > bytes.size() - at - frame ||
        crc32(&bytes[at + 4], length + 4) != wholeNumber(&bytes[at + 8 + length], 4))
      return false;
    const bool is_last = std::equal(&bytes[at + 4], &bytes[at + 8], "IEND");
    at += frame + length;
    if (is_last)
      return at == bytes.size();
  }
  return false;
}

// OpenCV would print a message for a truncated file and invent the missing rows.
void
requireWholeJpeg(const Bytes& bytes, const std::string& path)
{
  // All three bytes, by which OpenCV detects JPEG. Otherwise it would try other
  // formats, and GDCM terminates the program for a damaged DICOM file.
  if (bytes.size() < 4 || !beginsWith(bytes, {0xFF, 0xD8, 0xFF}))
    badInput(path, ": is not a JPEG image");
  std::size_t end = bytes.size();
  while (end > 2 && bytes[end - 1] == 0)
    --end;
  if (bytes[end - 2] != 0xFF || bytes[end - 1] != 0xD9)
    badInput(path, ": the JPEG image is not complete");
}

struct KindRule {
  std::vector<int> types;
  const char* name;
};

const KindRule&
ruleOf(ImageKind kind)
{
  static const KindRule rules[] = {
      {{CV_8UC1, CV_8UC3}, "8-bit grey or 8-bit RGB"},
      {{CV_8UC1}, "8-bit grey (class ids)"},
      {{CV_8UC1, CV_16UC1}, "8-bit or 16-bit grey (numbers of segments)"},
      {{CV_16UC1}, "16-bit grey (disparities)"},
      {{CV_16UC1, CV_32FC1}, "16-bit grey, or 32-bit float TIFF (depths)"}};
  return rules[std::size_t(kind)];
}

void
requireKind(const cv::Mat& image, ImageKind kind, const std::string& path)
{
  const KindRule& rule = ruleOf(kind);
  if (!std::count(rule.types.begin(), rule.types.end(), image.type()))
    badInput(path, ": has ", image.channels(), " channel(s) of ", 8 * image.elemSize1(),
             " bits, expected ", rule.name);
}

StatedSize
sizeOf(const cv::Mat& image)
{
  return {std::uint64_t(image.cols), std::uint64_t(image.rows)};
}

// A small file may decompress to gigabytes.
void
requireSize(const StatedSize& stated, cv::Size size, const std::string& like,
            const std::string& path)
{
  if (!size.empty() && stated.columns != 0 && stated.rows != 0 &&
      (stated.columns != std::uint64_t(size.width) ||
       stated.rows != std::uint64_t(size.height)))
    badInput(path, ": has ", stated.columns, " x ", stated.rows, " pixels, expected ",
             size.width, " x ", size.height, like);
}

cv::Mat
decode(const Bytes& bytes, int flags)
{
  try {
    return cv::imdecode(bytes, flags);
  }
  catch (const cv::Exception&) {
    return {};
  }
}

// Decodes a JPEG or TIFF image, whose headers do not always state their size.
cv::Mat
decodeOther(const Bytes& bytes, int flags, const char* format, ImageKind kind,
            cv::Size size, const std::string& like, const std::string& path)
{
  requirePlausibleSize(bytes, path);
  requireSize(statedSize(bytes), size, like, path);
  const QuietOpenCv quiet;
  const cv::Mat image = decode(bytes, flags);
  if (image.cols < 2 || image.rows < 2)
    badInput(path, ": the ", format, " image is damaged");
  requireSize(sizeOf(image), size, like, path);
  requireKind(image, kind, path);
  return image;
}

cv::Mat
readJpeg(const std::string& path, cv::Size size, const std::string& like)
{
  const Bytes bytes = readBytes(path);
  requireWholeJpeg(bytes, path);
  return decodeOther(bytes, cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION, "JPEG",
                     ImageKind::grey_or_colour, size, like, path);
}

std::string
extensionOf(const std::string& path)
{
  return boost::algorithm::to_lower_copy(
      std::filesystem::path(path).extension().string());
}

bool
isTiff(const std::string& path)
{
  const std::string extension = extensionOf(path);
  return extension == ".tif" || extension == ".tiff";
}

cv::Mat
readTiff(const std::string& path, ImageKind kind, cv::Size size,
         const std::string& like)
{
  const Bytes bytes = readBytes(path);
  if (bytes.size() < 8 ||
      (!beginsWith(bytes, {'I', 'I', 42, 0}) && !beginsWith(bytes, {'M', 'M', 0, 42})))
    badInput(path, ": is not a TIFF image");
  return decodeOther(bytes, cv::IMREAD_UNCHANGED, "TIFF", kind, size, like, path);
}

} // namespace

const std::vector<std::string>&
imageExtensions()
{
  static const std::vector<std::string> extensions{".png", ".jpg", ".jpeg", ".tif",
                                                   ".tiff"};
  return extensions;
}

cv::Mat
readImage(const std::string& path, cv::Size size, const std::string& like)
{
  const std::string extension = extensionOf(path);
  if (extension == ".jpg" || extension == ".jpeg")
    return readJpeg(path, size, like);
  return isTiff(path) ? readTiff(path, ImageKind::grey_or_colour, size, like)
                      : readPng(path, ImageKind::grey_or_colour, size, like);
}

cv::Mat
readDepthImage(const std::string& path, cv::Size size, const std::string& like)
{
  return isTiff(path) ? readTiff(path, ImageKind::depth, size, like)
                      : readPng(path, ImageKind::depth, size, like);
}

cv::Mat
readPng(const std::string& path, ImageKind kind, cv::Size size, const std::string& like)
{
  const Bytes bytes = readBytes(path);
  constexpr std::size_t bit_depth = 24, colour_type = 25; // in the header chunk
  constexpr std::uint8_t palette = 3;
  if (bytes.size() <= colour_type ||
      !beginsWith(bytes, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}))
    badInput(path, ": is not a PNG image");
  if (!isWhole(bytes))
    badInput(path, ": the PNG image is damaged or not complete");
  requirePlausibleSize(bytes, path);
  requireSize(statedSize(bytes), size, like, path);
  // Decoders scale fewer bits to 0..255, which would change class ids.
  if ((kind == ImageKind::labels || kind == ImageKind::segments) &&
      bytes[bit_depth] < 8)
    badInput(path, ": has ", int(bytes[bit_depth]), " bit(s) a pixel, expected ",
             ruleOf(kind).name);
  if (kind == ImageKind::labels && bytes[colour_type] == palette)
    badInput(path, ": has a palette, expected ", ruleOf(kind).name,
             "; write the palette indices as grey");
  const cv::Mat image = decode(bytes, cv::IMREAD_UNCHANGED);
  if (image.empty())
    badInput(path, ": the PNG image is damaged");
  requireKind(image, kind, path);
  if (image.cols < 2 || image.rows < 2)
    badInput(path, ": has ", image.cols, " x ", image.rows,
             " pixels, expected 2 x 2 or more");
  return image;
}

void
writePng(const std::string& path, const cv::Mat& image)
{
  Bytes bytes;
  if (image.empty() || !cv::imencode(".png", image, bytes))
    fail<OutputException>(path, ": cannot be encoded as PNG");
  writeBytes(path, bytes.data(), bytes.size());
}

} // namespace pcl_semantic
