// SPDX-License-Identifier: BSD-3-Clause
#include "census_image.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace pcl_semantic {

namespace {

constexpr int half_width = 4, half_height = 3;

// Sets a bit where one pixel is darker than another.
void
setDarker(const std::uint8_t* one, const std::uint8_t* other, int count,
          std::uint8_t bit, std::uint8_t* __restrict__ bytes)
{
  for (int u = 0; u < count; ++u)
    bytes[u] = std::uint8_t(bytes[u] | (one[u] < other[u] ? bit : 0));
}

} // namespace

CensusImage::CensusImage(const cv::Mat& grey, Order order, int padding)
    : stride_(std::size_t(grey.cols + padding))
{
  cv::Mat padded;
  cv::copyMakeBorder(grey, padded, half_height, half_height, half_width, half_width,
                     cv::BORDER_REPLICATE);
  for (auto& bytes : bytes_)
    bytes.assign(stride_ * std::size_t(grey.rows), 0);
#pragma omp parallel for schedule(static)
  for (int v = 0; v < grey.rows; ++v)
    computeRow(padded, grey.cols, order, v);
}

void
CensusImage::computeRow(const cv::Mat& padded, int width, Order order, int v)
{
  const auto rowAt = [&](int dx, int dy) {
    return padded.ptr<std::uint8_t>(v + half_height + dy) + half_width + dx;
  };
  int bit = 0;
  for (int dy = -half_height; dy <= half_height; ++dy)
    for (int dx = -half_width; dx <= half_width; ++dx)
      if ((dx + dy) % 2 != 0) {
        auto& bytes = bytes_[std::size_t(bit / 8)];
        setDarker(rowAt(dx, dy), rowAt(0, 0), width, std::uint8_t(1 << bit % 8),
                  bytes.data() + std::size_t(v) * stride_);
        ++bit;
      }
  for (auto& bytes : bytes_) {
    std::uint8_t* const begin = bytes.data() + std::size_t(v) * stride_;
    if (order == Order::backwards)
      std::reverse(begin, begin + width);
    std::fill(begin + width, begin + stride_, begin[width - 1]);
  }
}

} // namespace pcl_semantic
