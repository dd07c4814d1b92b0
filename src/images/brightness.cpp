// SPDX-License-Identifier: BSD-3-Clause
#include "brightness.h"

#include "grey_image.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace pcl_semantic {

int
medianGrey(const cv::Mat& image)
{
  std::array<std::size_t, 256> counts{};
  const cv::Mat1b grey = greyImage(image);
  for (const std::uint8_t level : grey)
    ++counts[level];
  int median = 0;
  for (std::size_t sum = counts[0]; 2 * sum <= grey.total(); ++median)
    sum += counts[std::size_t(median) + 1];
  return median;
}

} // namespace pcl_semantic
