// SPDX-License-Identifier: BSD-3-Clause
#include "semi_global_matcher.h"
#include "disparity_cleaning.h"
#include "image_pair.h"
#include "images/grey_image.h"
#include "kernels/smoothing.h"
#include "parallel_bands.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdlib>

namespace pcl_semantic {

namespace {

constexpr int half_width = 4, half_height = 3; // of the census [px]
constexpr int block_radius = 2;
constexpr int small_step = 24; // P1; a cost is at most 31 x 25 / 16
// P2 in smooth areas. With the costs of a block it stays below kernels::max_path_cost.
constexpr int large_step = 120;
constexpr int edge = 6;       // P2 decreases from this grey level difference on
constexpr int uniqueness = 5; // minimum margin of the best sum over the others [%]
constexpr int left_right_tolerance = 1; // left-right check [px]
constexpr int smoothing_rounds = 1;
constexpr int gap_step = 1; // [px]

// Fixed, so that the result does not depend on the number of threads.
constexpr int band_rows = 96;
constexpr int rows_before = 16; // before a band, because longer paths have little
                                // influence

// Sets a bit where pixels of one row are darker than those of the other.
void
setDarker(const std::uint8_t* one, const std::uint8_t* other, int count,
          std::uint8_t bit, std::uint8_t* __restrict__ bytes)
{
  for (int u = 0; u < count; ++u)
    bytes[u] = std::uint8_t(bytes[u] | (one[u] < other[u] ? bit : 0));
}

// Slots with their paddings; a path begins with zeros.
std::vector<std::uint8_t>
makeSlots(int count, int disparities)
{
  const std::size_t padding = kernels::slot_padding;
  const std::size_t size = std::size_t(disparities) + padding;
  std::vector<std::uint8_t> slots(padding + std::size_t(count) * size,
                                  kernels::max_path_cost);
  for (int i = 0; i < count; ++i)
    std::fill_n(slots.begin() + long(padding + std::size_t(i) * size), disparities,
                std::uint8_t(0));
  return slots;
}

} // namespace

CensusImage::CensusImage(const cv::Mat& grey, Order order, int padding)
    : stride_(std::size_t(grey.cols + padding))
{
  cv::Mat padded;
  // Isolated: without pixels around a view.
  cv::copyMakeBorder(grey, padded, half_height, half_height, half_width, half_width,
                     cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
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

SemiGlobalBand::SemiGlobalBand(const Pair& pair, int disparities, SimdTier tier)
    : pair_(pair), loops_(kernels::semiGlobal(tier)), width_(pair.grey.cols),
      disparities_(disparities)
{
  for (int difference = 0; difference < 256; ++difference)
    large_step_[std::size_t(difference)] = std::uint8_t(
        std::max(small_step + 1, large_step * edge / std::max(edge, difference)));
  const std::size_t width = std::size_t(width_), D = std::size_t(disparities_);
  for (Bytes& row : rows_)
    row.resize(width * D);
  for (Bytes* const bytes : {&added_row_, &row_sums_, &quarters_, &costs_})
    bytes->resize(width * D);
  for (Bytes* const bytes : {&steps_down_, &steps_along_, &best_, &has_rival_})
    bytes->resize(width + 1);
  along_ = makeSlots(1, disparities_);
  sums_.resize(width * D);
  around_.resize(3 * width);
  for (int parity = 0; parity < 2; ++parity)
    for (Shorts* const values : {&right_sum_[parity], &right_disparity_[parity]})
      values->resize((width + D) / 2 + kernels::disparity_block);
}

void
SemiGlobalBand::match(int begin, int end, cv::Mat& disparity)
{
  const int first = std::max(0, begin - rows_before);
  down_ = makeSlots(width_, disparities_);
  smallest_down_.assign(std::size_t(width_), 0);
  std::fill(row_sums_.begin(), row_sums_.end(), std::uint8_t(0));
  next_row_ = first - block_radius;
  for (int v = first; v < end; ++v) {
    const kernels::PathRow row = pathRow(v);
    loops_.forward(row);
    if (v < begin)
      continue;
    loops_.backward(row, clearMatches());
    for (int u = 0; u < width_; ++u)
      disparity.at<std::int16_t>(v, u) = matchOf(u);
  }
}

const std::uint8_t*
SemiGlobalBand::costsOf(int v)
{
  const std::size_t count = row_sums_.size();
  const bool is_first = next_row_ < v + block_radius;
  for (; next_row_ <= v + block_radius; ++next_row_) {
    const int from = std::clamp(next_row_, 0, pair_.grey.rows - 1);
    kernels::CensusRow row{width_, disparities_, {}, {}};
    for (int b = 0; b < kernels::census_bytes; ++b) {
      row.left[b] = pair_.left.row(b, from);
      row.right[b] = pair_.right.row(b, from);
    }
    Bytes& removed = rows_[std::size_t((next_row_ + 5) % 5)];
    loops_.compare(row, added_row_.data());
    loops_.slide(added_row_.data(), is_first ? nullptr : removed.data(), count,
                 row_sums_.data(), quarters_.data());
    std::swap(added_row_, removed);
  }
  loops_.blocks(quarters_.data(), width_, disparities_, costs_.data());
  return costs_.data();
}

kernels::PathRow
SemiGlobalBand::pathRow(int v)
{
  const std::uint8_t* const here = pair_.grey.ptr<std::uint8_t>(v);
  const std::uint8_t* const above = pair_.grey.ptr<std::uint8_t>(std::max(v - 1, 0));
  const auto stepBetween = [&](std::uint8_t a, std::uint8_t b) {
    return large_step_[std::size_t(std::abs(a - b))];
  };
  for (int u = 0; u < width_; ++u)
    steps_down_[std::size_t(u)] = stepBetween(here[u], above[u]);
  for (int u = 0; u <= width_; ++u)
    steps_along_[std::size_t(u)] =
        stepBetween(here[std::min(u, width_ - 1)], here[std::max(u - 1, 0)]);
  return {width_,
          disparities_,
          costsOf(v),
          std::uint8_t(small_step),
          steps_down_.data(),
          steps_along_.data(),
          down_.data() + kernels::slot_padding,
          smallest_down_.data(),
          along_.data() + kernels::slot_padding,
          sums_.data()};
}

kernels::RowMatches
SemiGlobalBand::clearMatches()
{
  for (Shorts& sums : right_sum_)
    std::fill(sums.begin(), sums.end(), kernels::no_sum);
  return {best_.data(),
          around_.data(),
          has_rival_.data(),
          100.0f / float(100 - uniqueness),
          {right_sum_[0].data(), right_sum_[1].data()},
          {right_disparity_[0].data(), right_disparity_[1].data()}};
}

// The disparity of a pixel that passes the left-right check.
std::int16_t
SemiGlobalBand::matchOf(int u) const
{
  const int d = best_[std::size_t(u)];
  if (d > u || has_rival_[std::size_t(u)])
    return kernels::no_disparity;
  const int position = width_ - 1 - u + d;
  const int theirs = right_disparity_[position % 2][std::size_t(position / 2)];
  if (std::abs(theirs - d) > left_right_tolerance)
    return kernels::no_disparity;
  const std::uint16_t* const around = around_.data() + 3 * u;
  if (d == 0 || d == disparities_ - 1)
    return std::int16_t(d * kernels::disparity_steps);
  // Two lines of equal and opposite slope through the three sums.
  const float before = float(around[0]) - float(around[1]);
  const float behind = float(around[2]) - float(around[1]);
  const float steepest = std::max({before, behind, 1.0f});
  const float shift = 0.5f * (before - behind) / steepest;
  return std::int16_t((float(d) + shift) * kernels::disparity_steps + 0.5f);
}

DisparityImage
SemiGlobalMatcher::estimate(const cv::Mat& left, const cv::Mat& right)
{
  requireImagePair(left, right);
  const cv::Mat grey = greyImage(left);
  const CensusImage left_census(grey, CensusImage::Order::forwards, 0);
  const CensusImage right_census(greyImage(right), CensusImage::Order::backwards,
                                 disparities_ + kernels::disparity_block);
  cv::Mat disparity(grey.size(), CV_16SC1);
  forBandsOfRows(
      grey.rows, band_rows,
      [&] {
        return SemiGlobalBand({grey, left_census, right_census}, disparities_);
      },
      [&](SemiGlobalBand& band, int begin, int end) {
        band.match(begin, end, disparity);
      });
  return cleanDisparity(smoothing_rounds, gap_step, disparity);
}

} // namespace pcl_semantic
