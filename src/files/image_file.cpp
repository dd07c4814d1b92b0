/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/image_file.h>
#include <pcl_semantic/files/input_file.h>

#include <opencv2/imgcodecs.hpp>

#include <algorithm>

namespace pcl_semantic {

namespace {

constexpr std::uint8_t signature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::uint8_t last_chunk[] = {'I', 'E', 'N', 'D', 0xAE, 0x42, 0x60, 0x82};

bool
hasKind(const cv::Mat& image, ImageKind kind)
{
  switch (kind) {
  case ImageKind::grey_or_colour:
    return image.type() == CV_8UC1 || image.type() == CV_8UC3;
  case ImageKind::labels:
    return image.type() == CV_8UC1;
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
  case ImageKind::disparity:
    return "16-bit grey (256 x disparity)";
  }
  return "";
}

} // namespace

cv::Mat
readPng(const std::string& path, ImageKind kind)
{
  const std::vector<std::uint8_t> bytes = readBytes(path);
  if (bytes.size() < 16 || !std::equal(std::begin(signature), std::end(signature), bytes.begin()))
    PCL_THROW_EXCEPTION(BadInputException, path << ": is not a PNG image");
  if (!std::equal(std::begin(last_chunk), std::end(last_chunk), bytes.end() - 8))
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": the PNG image is damaged: its end is missing");
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
    PCL_THROW_EXCEPTION(BadInputException,
                        path << ": is only " << image.cols << " x " << image.rows
                             << " pixels");
  return image;
}

void
writePng(const std::string& path, const cv::Mat& image)
{
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", image, bytes);
  AtomicFile file(path);
  file.stream().write(reinterpret_cast<const char*>(bytes.data()),
                      std::streamsize(bytes.size()));
  file.commit();
}

} // namespace pcl_semantic
