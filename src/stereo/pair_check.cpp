// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/stereo/pair_check.h>

#include "image_pair.h"
#include "images/grey_image.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr int working_width = 640; // images are reduced by an integer factor to about
                                   // this width
constexpr int block_width = 16;    // [px of the reduced image], as below
constexpr int block_height = 8;
constexpr int grid_columns = 20;
constexpr int grid_rows = 10;
constexpr int range_fraction = 8; // the maximum disparity is the width divided by this
constexpr int min_gradient = 3;   // mean over a textured block
constexpr int min_disparity = 2;  // smaller disparities are ambiguous: far points or
                                  // rectification errors

// Thresholds in the middle of wide gaps between the pairs of doc/stereo.md.
constexpr double blank_contrast = 2.0;
constexpr double alike_fraction = 0.4;
constexpr double matched_fraction = 0.03;
constexpr int enough_matches = 12;
constexpr int enough_textured = 60;

// Rows with the searched blocks, stacked.
using Bands = cv::Mat1b;

Bands
reducedBands(const cv::Mat& image)
{
  const int factor = std::max(1, int(std::lround(double(image.cols) / working_width)));
  const int width = image.cols / factor, height = block_height * factor;
  if (width == 0 || image.rows < height)
    return {};
  Bands bands(grid_rows * block_height, width);
  for (int j = 0; j < grid_rows; ++j) {
    const int top = (image.rows - height) * j / (grid_rows - 1);
    cv::Mat band = bands.rowRange(j * block_height, (j + 1) * block_height);
    cv::resize(greyImage(image(cv::Rect(0, top, width * factor, height))), band,
               band.size(), 0.0, 0.0, cv::INTER_AREA);
  }
  return bands;
}

// Contrast of averages over areas, which suppress noise.
double
contrastOf(const cv::Mat& image, const Bands& bands)
{
  cv::Mat coarse;
  cv::resize(bands.empty() ? greyImage(image) : cv::Mat(bands), coarse,
             cv::Size(32, grid_rows), 0.0, 0.0, cv::INTER_AREA);
  cv::Scalar mean, deviation;
  cv::meanStdDev(coarse, mean, deviation);
  return deviation[0];
}

bool
isIdentical(const cv::Mat& left, const cv::Mat& right)
{
  for (int v = 0; v < left.rows; ++v)
    if (cv::norm(left.row(v), right.row(v), cv::NORM_INF) != 0.0)
      return false;
  return true;
}

// Differences along rows, 128 = none: independent of brightness.
Bands
gradientOf(const Bands& grey)
{
  Bands gradient(grey.size(), std::uint8_t(128));
  if (grey.cols < 3)
    return gradient;
  cv::Mat inside = gradient.colRange(1, grey.cols - 1);
  cv::addWeighted(grey.colRange(2, grey.cols), 1.0, grey.colRange(0, grey.cols - 2),
                  -1.0, 128.0, inside);
  return gradient;
}

bool
isTextured(const Bands& gradient, int u, int v)
{
  int sum = 0;
  for (int row = v; row < v + block_height; ++row)
    for (int i = 0; i < block_width; ++i)
      sum += std::abs(gradient[row][u + i] - 128);
  return sum >= min_gradient * block_width * block_height;
}

int
differenceOf(const Bands& a, int ua, const Bands& b, int ub, int v)
{
  int sum = 0;
  for (int row = v; row < v + block_height; ++row) {
    const std::uint8_t* const from_a = a[row] + ua;
    const std::uint8_t* const from_b = b[row] + ub;
    for (int i = 0; i < block_width; ++i)
      sum += std::abs(from_a[i] - from_b[i]);
  }
  return sum;
}

struct BlockMatch {
  int u = 0;
  bool is_alike = false;  // far better than the mean over all positions
  bool is_unique = false; // clearly better than all other positions
};

BlockMatch
findBlock(const Bands& from, const Bands& to, int u, int v)
{
  const int range = to.cols / range_fraction;
  const int first = std::max(0, u - range);
  const int last = std::min(to.cols - block_width, u + range);
  int costs[2 * 1024 / range_fraction + 1];
  const int count = last - first + 1;
  double sum = 0.0;
  for (int i = 0; i < count; ++i)
    sum += costs[i] = differenceOf(from, u, to, first + i, v);
  const int best = int(std::min_element(costs, costs + count) - costs);
  int second = std::numeric_limits<int>::max();
  for (int i = 0; i < count; ++i)
    if (std::abs(i - best) > 2)
      second = std::min(second, costs[i]);
  return {first + best, costs[best] < 0.5 * sum / count, costs[best] < 0.7 * second};
}

struct Matches {
  int textured = 0; // number of searched blocks
  int alike = 0;    // of these, blocks similar to some position of their row
  int matched = 0;  // unique, and confirmed from the right image
  int forward = 0;  // of these, clearly further left in the right image
  int backward = 0; // of these, clearly further right
};

Matches
countMatches(const Bands& left, const Bands& right)
{
  Matches matches;
  const int range = left.cols / range_fraction;
  // In both directions, all positions are inside the image.
  const int columns = left.cols - 2 * range - block_width;
  for (int j = 0; j < grid_rows * grid_columns && columns > 0; ++j) {
    const int v = j / grid_columns * block_height;
    const int u = range + columns * (j % grid_columns) / (grid_columns - 1);
    if (!isTextured(left, u, v))
      continue;
    ++matches.textured;
    const BlockMatch match = findBlock(left, right, u, v);
    matches.alike += match.is_alike;
    if (!match.is_alike || !match.is_unique)
      continue;
    const BlockMatch back = findBlock(right, left, match.u, v);
    if (!back.is_unique || std::abs(back.u - u) > 1)
      continue;
    ++matches.matched;
    matches.forward += u - match.u >= min_disparity;
    matches.backward += match.u - u >= min_disparity;
  }
  return matches;
}

} // namespace

PairReport
checkPair(const cv::Mat& left, const cv::Mat& right)
{
  requireImagePair(left, right);
  const Bands left_bands = reducedBands(left), right_bands = reducedBands(right);
  Matches found;
  if (!left_bands.empty())
    found = countMatches(gradientOf(left_bands), gradientOf(right_bands));
  const double contrast[] = {contrastOf(left, left_bands),
                             contrastOf(right, right_bands)};
  // A fence has no coarse contrast either, but is similar in both images; noise is not.
  const auto [low, high] = std::minmax(contrast[0], contrast[1]);
  if (low < blank_contrast &&
      (high > 2.0 * blank_contrast || found.alike <= alike_fraction * found.textured))
    return {PairFault::blank, high < blank_contrast
                                  ? "both images are blank: covered lenses?"
                                  : std::string("the ") +
                                        (low == contrast[0] ? "left" : "right") +
                                        " image is blank: a covered lens?"};
  if (isIdentical(left, right))
    return {PairFault::identical, "left and right are the same image"};
  // Repeated texture is similar at many positions and matched nowhere.
  if (found.textured >= enough_textured &&
      found.alike < alike_fraction * found.textured &&
      found.matched < matched_fraction * found.textured)
    return {PairFault::unrelated,
            "left and right do not show the same rows: of " +
                std::to_string(found.textured) + " positions, " +
                std::to_string(found.matched) +
                " were found in both; is the pair of one moment and rectified?"};
  if (found.backward >= enough_matches && found.backward > 4 * found.forward)
    return {PairFault::swapped, "left and right are swapped: of " +
                                    std::to_string(found.forward + found.backward) +
                                    " positions found in both, " +
                                    std::to_string(found.backward) +
                                    " lie further right in the right image"};
  return {};
}

} // namespace pcl_semantic
