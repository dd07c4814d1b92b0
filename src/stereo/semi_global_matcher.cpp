// SPDX-License-Identifier: BSD-3-Clause
#include "semi_global_matcher.h"
#include "core/grey_image.h"
#include "core/parallel_guard.h"
#include "disparity_cleaning.h"
#include "image_pair.h"
#include "kernels/map_disparity.h"
#include "semi_global_band.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <optional>

namespace pcl_semantic {

namespace {

constexpr int steps = kernels::disparity_steps;

// Fixed, so that the result does not depend on the number of threads.
constexpr int band_rows = 96;

cv::Mat
matchBands(const SemiGlobalBand::Pair& pair,
           const SemiGlobalMatcher::Parameters& parameters)
{
  const int rows = pair.grey.rows;
  cv::Mat disparity(pair.grey.size(), CV_16SC1);
  ParallelGuard guard;
#pragma omp parallel
  {
    std::optional<SemiGlobalBand> band;
    guard.run([&] { band.emplace(pair, parameters); });
#pragma omp for schedule(dynamic)
    for (int begin = 0; begin < rows; begin += band_rows)
      guard.run([&] {
        if (band)
          band->match(begin, std::min(begin + band_rows, rows), disparity);
      });
  }
  guard.rethrow();
  return disparity;
}

void
require(bool valid, const char* name, double value, const char* expected)
{
  if (!valid)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "semi-global matching: " << name << " is " << value
                                                 << ", expected " << expected);
}

} // namespace

void
SemiGlobalMatcher::Parameters::validate() const
{
  const auto within = [](double value, double low, double high) {
    return value >= low && value <= high;
  };
  require(disparities > 0 && disparities <= 256 &&
              disparities % kernels::disparity_block == 0,
          "disparities", disparities, "64, 128, 192 or 256");
  require(within(small_step, 1, 60), "small_step", small_step, "1 to 60");
  // With the costs of a block it stays below kernels::max_path_cost.
  require(large_step > small_step && large_step <= 140, "large_step", large_step,
          "more than small_step, at most 140");
  require(within(edge, 1, 255), "edge", edge, "1 to 255");
  require(within(uniqueness, 0, 50), "uniqueness", uniqueness, "0 to 50");
  require(within(left_right_tolerance, 0, 256), "left_right_tolerance",
          left_right_tolerance, "0 to 256");
  require(speckle_size >= 0, "speckle_size", speckle_size, "0 or more");
  require(within(speckle_range, 0, 1024), "speckle_range", speckle_range, "0 to 1024");
  require(within(smoothing_radius, 0, 16), "smoothing_radius", smoothing_radius,
          "0 to 16");
  require(within(smoothing_range, 0, 50), "smoothing_range", smoothing_range,
          "0 to 50");
  require(gap_width >= 0, "gap_width", gap_width, "0 or more");
  require(within(gap_step, 0, 1024), "gap_step", gap_step, "0 to 1024");
}

SemiGlobalMatcher::SemiGlobalMatcher(const Parameters& parameters)
    : parameters_(parameters)
{
  parameters_.validate();
}

DisparityImage
SemiGlobalMatcher::estimate(const cv::Mat& left, const cv::Mat& right)
{
  requireImagePair(left, right);
  const cv::Mat grey = greyImage(left);
  const int padding = parameters_.disparities + kernels::disparity_block;
  const CensusImage left_census(grey, CensusImage::Order::forwards, 0);
  const CensusImage right_census(greyImage(right), CensusImage::Order::backwards,
                                 padding);
  cv::Mat disparity = matchBands({grey, left_census, right_census}, parameters_);
  removeSmallSegments(parameters_.speckle_size, int(parameters_.speckle_range * steps),
                      disparity);
  if (parameters_.smoothing_radius > 0)
    smoothDisparity(parameters_.smoothing_radius,
                    int(parameters_.smoothing_range * steps), disparity);
  return fillGaps(parameters_.gap_width, int(parameters_.gap_step * steps), disparity);
}

} // namespace pcl_semantic
