// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/stereo/pair_check.h>

#include "core/grey_image.h"
#include "image_pair.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace pcl_semantic {

namespace {

constexpr int working_width = 640; // images are reduced, by a whole number, to about it
constexpr int block_width = 16;    // [px of the reduced image], as all that follows
constexpr int block_height = 8;
constexpr int grid_columns = 20;
constexpr int grid_rows = 10;
constexpr int range_fraction = 8; // disparities up to the width by this
constexpr int min_gradient = 3;   // of a textured block, on average
constexpr int min_disparity = 2;  // below, a point may be far or badly rectified

// What separates the pairs of doc/stereo.md, in the middle of wide gaps.
constexpr double blank_contrast = 2.0;
constexpr double alike_fraction = 0.4;
constexpr double matched_fraction = 0.03;
constexpr int enough_matches = 12;
constexpr int enough_textured = 60;

constexpr int memory = 1000; // of blocks of earlier pairs

// The textured blocks of an image are sought in such rows only; stacked.
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

// Of means over positions so large that noise is gone.
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
    if (std::memcmp(left.ptr(v), right.ptr(v),
                    std::size_t(left.cols) * left.elemSize()) != 0)
      return false;
  return true;
}

// Differences along rows, 128 = none: a camera that is brighter changes nothing.
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
  bool is_alike = false;  // far better than the average position
  bool is_unique = false; // clearly better than any other position
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

void
countMatches(const Bands& left, const Bands& right, PairEvidence& evidence)
{
  const int range = left.cols / range_fraction;
  // Both directions have all their positions in the image.
  const int columns = left.cols - 2 * range - block_width;
  for (int j = 0; j < grid_rows * grid_columns && columns > 0; ++j) {
    const int v = j / grid_columns * block_height;
    const int u = range + columns * (j % grid_columns) / (grid_columns - 1);
    if (!isTextured(left, u, v))
      continue;
    ++evidence.textured;
    const BlockMatch match = findBlock(left, right, u, v);
    evidence.alike += match.is_alike;
    if (!match.is_alike || !match.is_unique)
      continue;
    const BlockMatch back = findBlock(right, left, match.u, v);
    if (!back.is_unique || std::abs(back.u - u) > 1)
      continue;
    ++evidence.matched;
    evidence.forward += u - match.u >= min_disparity;
    evidence.backward += match.u - u >= min_disparity;
  }
}

constexpr int PairEvidence::*counts[] = {&PairEvidence::textured, &PairEvidence::alike,
                                         &PairEvidence::matched, &PairEvidence::forward,
                                         &PairEvidence::backward};

} // namespace

PairFault
PairEvidence::fault() const
{
  // A fence has no coarse contrast either, but is in both images and alike; noise is
  // not.
  const auto [low, high] = std::minmax(left_contrast, right_contrast);
  if (low < blank_contrast &&
      (high > 2.0 * blank_contrast || alike <= alike_fraction * textured))
    return PairFault::blank;
  if (is_identical)
    return PairFault::identical;
  // Repeated texture is alike in many positions, but matched nowhere.
  if (textured >= enough_textured && alike < alike_fraction * textured &&
      matched < matched_fraction * textured)
    return PairFault::unrelated;
  if (backward >= enough_matches && backward > 4 * forward)
    return PairFault::swapped;
  return PairFault::none;
}

std::string
PairEvidence::reason() const
{
  switch (fault()) {
  case PairFault::blank:
    if (std::max(left_contrast, right_contrast) < blank_contrast)
      return "both images are blank: covered lenses?";
    return std::string("the ") + (left_contrast < right_contrast ? "left" : "right") +
           " image is blank: a covered lens?";
  case PairFault::identical:
    return "left and right are the same image";
  case PairFault::swapped:
    return "left and right are swapped: of " + std::to_string(forward + backward) +
           " positions found in both, " + std::to_string(backward) +
           " lie further right in the right image";
  case PairFault::unrelated:
    return "left and right do not show the same rows: of " + std::to_string(textured) +
           " positions, " + std::to_string(matched) +
           " were found in both; is the pair of one moment and rectified?";
  case PairFault::none:
    break;
  }
  return "";
}

PairEvidence
gatherPairEvidence(const cv::Mat& left, const cv::Mat& right)
{
  requireImagePair(left, right);
  PairEvidence evidence;
  const Bands left_bands = reducedBands(left), right_bands = reducedBands(right);
  evidence.left_contrast = contrastOf(left, left_bands);
  evidence.right_contrast = contrastOf(right, right_bands);
  evidence.is_identical = isIdentical(left, right);
  if (!left_bands.empty())
    countMatches(gradientOf(left_bands), gradientOf(right_bands), evidence);
  return evidence;
}

PairFault
PairCheck::add(const cv::Mat& left, const cv::Mat& right)
{
  judged_ = gatherPairEvidence(left, right);
  const PairFault fault = judged_.fault();
  if (fault == PairFault::blank || fault == PairFault::identical)
    return fault;
  const int divisor = gathered_.textured > memory ? 2 : 1;
  for (const auto count : counts)
    gathered_.*count = gathered_.*count / divisor + judged_.*count;
  gathered_.left_contrast = judged_.left_contrast;
  gathered_.right_contrast = judged_.right_contrast;
  if (fault == PairFault::none && judged_.forward + judged_.backward < enough_matches)
    judged_ = gathered_;
  return judged_.fault();
}

} // namespace pcl_semantic
