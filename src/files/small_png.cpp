// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/small_png.h>

#include <opencv2/imgcodecs.hpp>

#include <algorithm>

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

} // namespace pcl_semantic
