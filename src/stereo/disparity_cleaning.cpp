// SPDX-License-Identifier: BSD-3-Clause
#include "disparity_cleaning.h"
#include "core/disjoint_sets.h"
#include "kernels/smoothing.h"
#include "parallel_bands.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr int min_segment = 200; // [px]
constexpr int segment_range = kernels::disparity_steps;
constexpr int smoothing_radius = 5; // [px]
constexpr int smoothing_range = 4 * kernels::disparity_steps;

// 68 % quantiles of the absolute errors on KITTI, gross errors included (doc/stereo.md)
// [px].
constexpr float deviation_matched = 0.53f;
constexpr float deviation_between = 0.94f; // between similar ends of a gap
constexpr float deviation_beyond = 5.4f;   // at a depth discontinuity or the border

/** \brief Connected pixels [first, last] of a row. */
struct Run {
  std::int16_t* row;
  int first, last;
};

void
findRuns(std::int16_t* row, int width, int range, std::vector<Run>& runs)
{
  for (int u = 0; u < width; ++u)
    if (row[u] >= 0) {
      const int first = u;
      while (u + 1 < width && row[u + 1] >= 0 && std::abs(row[u + 1] - row[u]) <= range)
        ++u;
      runs.push_back({row, first, u});
    }
}

// Runs of neighbouring rows.
bool
belongTogether(const Run& a, const Run& b, int range)
{
  for (int u = std::max(a.first, b.first); u <= std::min(a.last, b.last); ++u)
    if (std::abs(a.row[u] - b.row[u]) <= range)
      return true;
  return false;
}

void
fillRow(const std::int16_t* row, int width, int step, float* disparity,
        float* deviation)
{
  const auto set = [&](int u, float value, float how_sure) {
    disparity[u] = value / float(kernels::disparity_steps);
    deviation[u] = value > 0.0f ? how_sure : 0.0f;
  };
  // Fills the pixels between two others, of which at least one has a disparity.
  const auto fill = [&](int before, int after) {
    const bool has_ends = before >= 0 && after < width;
    const float from = float(row[before >= 0 ? before : after]);
    const float to = float(row[after < width ? after : before]);
    const bool like = std::abs(to - from) <= float(step);
    const float slope = (to - from) / float(after - before);
    for (int u = before + 1; u < after; ++u)
      set(u, like ? from + slope * float(u - before) : std::min(from, to),
          like && has_ends ? deviation_between : deviation_beyond);
  };
  std::fill_n(disparity, width, 0.0f);
  std::fill_n(deviation, width, 0.0f);
  int before = -1; // last pixel with a disparity
  for (int u = 0; u <= width; ++u) {
    if (u < width && row[u] < 0)
      continue;
    if (before >= 0 || u < width)
      fill(before, u);
    if (u < width)
      set(u, float(row[u]), deviation_matched);
    before = u;
  }
}

} // namespace

void
removeSmallSegments(int size, int range, cv::Mat& disparity)
{
  std::vector<Run> runs;
  DisjointSets segments;
  std::size_t above = 0; // first run of the previous row
  for (int v = 0; v < disparity.rows; ++v) {
    const std::size_t current = runs.size();
    findRuns(disparity.ptr<std::int16_t>(v), disparity.cols, range, runs);
    segments.grow(runs.size());
    for (std::size_t a = above, b = current; a < current && b < runs.size();) {
      if (belongTogether(runs[a], runs[b], range))
        segments.joinMembers(int(a), int(b));
      ++(runs[a].last < runs[b].last ? a : b);
    }
    above = current;
  }
  std::vector<int> sizes(runs.size(), 0); // of the segments, by root [px]
  for (std::size_t i = 0; i < runs.size(); ++i)
    sizes[std::size_t(segments.rootOf(int(i)))] += runs[i].last - runs[i].first + 1;
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (sizes[std::size_t(segments.rootOf(int(i)))] < size)
      std::fill(runs[i].row + runs[i].first, runs[i].row + runs[i].last + 1,
                kernels::no_disparity);
}

void
smoothDisparity(cv::Mat& disparity)
{
  constexpr int radius = smoothing_radius, taps = 2 * radius + 1;
  static_assert(radius <= kernels::max_smoothing, "neighbours fit the kernel");
  const kernels::Smooth smooth = kernels::smoothing(simdTier());
  const int width = disparity.cols;
  cv::Mat result(disparity.size(), CV_16SC1);
  // One row with an empty margin.
  const auto makeRow = [&] {
    return std::vector<std::int16_t>(std::size_t(width + 2 * radius),
                                     kernels::no_disparity);
  };
  forBandsOfRows(disparity.rows, 16, makeRow,
                 [&](std::vector<std::int16_t>& row, int begin, int end) {
                   const std::int16_t* neighbours[taps];
                   for (int v = begin; v < end; ++v) {
                     for (int i = 0; i < taps; ++i)
                       neighbours[i] = disparity.ptr<std::int16_t>(
                           std::clamp(v + i - radius, 0, disparity.rows - 1));
                     smooth(disparity.ptr<std::int16_t>(v), neighbours, taps,
                            smoothing_range, width, row.data() + radius);
                     for (int i = 0; i < taps; ++i)
                       neighbours[i] = row.data() + i;
                     smooth(row.data() + radius, neighbours, taps, smoothing_range,
                            width, result.ptr<std::int16_t>(v));
                   }
                 });
  disparity = result;
}

DisparityImage
fillGaps(int step, const cv::Mat& disparity)
{
  DisparityImage result{cv::Mat(disparity.size(), CV_32FC1),
                        cv::Mat(disparity.size(), CV_32FC1)};
#pragma omp parallel for schedule(static)
  for (int v = 0; v < disparity.rows; ++v)
    fillRow(disparity.ptr<std::int16_t>(v), disparity.cols, step,
            result.disparity.ptr<float>(v), result.deviation.ptr<float>(v));
  return result;
}

DisparityImage
cleanDisparity(int smoothing_rounds, int gap_step, cv::Mat disparity)
{
  removeSmallSegments(min_segment, segment_range, disparity);
  for (int round = 0; round < smoothing_rounds; ++round)
    smoothDisparity(disparity);
  return fillGaps(gap_step * kernels::disparity_steps, disparity);
}

} // namespace pcl_semantic
