// SPDX-License-Identifier: BSD-3-Clause
#include "gradient_image.h"

#include <algorithm>

namespace pcl_semantic {

namespace {

constexpr int reach = 2; // of a descriptor [px]

struct Element {
  bool vertical;
  int u, v;
};

constexpr Element elements[kernels::descriptor_bytes] = {
    {false, -2, -2}, {false, 0, -2}, {false, 2, -2}, {false, -1, -1},
    {false, 1, -1},  {false, -2, 0}, {false, 0, 0},  {false, 2, 0},
    {false, -1, 1},  {false, 1, 1},  {false, -2, 2}, {false, 0, 2},
    {false, 2, 2},   {false, -1, 0}, {false, 1, 0},  {true, 0, 0},
};

} // namespace

GradientImage::GradientImage(const cv::Mat& grey)
    : width_(grey.cols), height_(grey.rows),
      stride_((grey.cols + 15) / 16 * 16 + 2 * kernels::gradient_margin),
      horizontal_(std::size_t(stride_) * std::size_t(height_), 128),
      vertical_(horizontal_)
{
  const kernels::Descriptors& loops = kernels::descriptors(simdTier());
#pragma omp parallel for schedule(static)
  for (int v = 0; v < height_; ++v) {
    const std::size_t at =
        std::size_t(v) * std::size_t(stride_) + kernels::gradient_margin;
    loops.gradients(grey.ptr(std::max(v - 1, 0)), grey.ptr(v),
                    grey.ptr(std::min(v + 1, height_ - 1)), width_,
                    horizontal_.data() + at, vertical_.data() + at);
  }
}

void
GradientImage::describeRow(int v, std::vector<std::uint8_t>& row) const
{
  constexpr int margin = kernels::descriptor_margin;
  const int count = stride_ - 2 * kernels::gradient_margin + 2 * margin;
  row.resize(std::size_t(count) * kernels::descriptor_bytes);
  const std::uint8_t* from[kernels::descriptor_bytes];
  for (int i = 0; i < kernels::descriptor_bytes; ++i) {
    const Element& element = elements[i];
    const int line = std::clamp(v + element.v, 0, height_ - 1);
    from[i] = (element.vertical ? vertical_ : horizontal_).data() +
              std::size_t(line) * std::size_t(stride_) + kernels::gradient_margin -
              margin + element.u;
  }
  kernels::descriptors(simdTier()).gather(from, count, row.data());
}

} // namespace pcl_semantic
