// SPDX-License-Identifier: BSD-3-Clause
#include "disparity_cleaning.h"
#include "core/parallel_guard.h"
#include "kernels/map_disparity.h"
#include "kernels/smoothing.h"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace pcl_semantic {

namespace {

/** \brief Pixels of a row from first on that belong together. */
struct Run {
  int first, last;
  int parent; ///< a run of the same segment, itself for the one that stands for it
  int size;   ///< of the segment, where it is the one [px]
};

int
rootOf(std::vector<Run>& runs, int run)
{
  while (runs[std::size_t(run)].parent != run) {
    Run& r = runs[std::size_t(run)];
    r.parent = runs[std::size_t(r.parent)].parent;
    run = r.parent;
  }
  return run;
}

void
join(std::vector<Run>& runs, int a, int b)
{
  a = rootOf(runs, a);
  b = rootOf(runs, b);
  if (a == b)
    return;
  if (a > b)
    std::swap(a, b);
  runs[std::size_t(b)].parent = a;
  runs[std::size_t(a)].size += runs[std::size_t(b)].size;
}

void
findRuns(const std::int16_t* row, int width, int range, std::vector<Run>& runs)
{
  for (int u = 0; u < width;) {
    if (row[u] < 0) {
      ++u;
      continue;
    }
    const int first = u++;
    while (u < width && row[u] >= 0 && std::abs(row[u] - row[u - 1]) <= range)
      ++u;
    runs.push_back({first, u - 1, int(runs.size()), u - first});
  }
}

void
joinRows(const std::int16_t* upper, const std::int16_t* lower, int range,
         std::vector<Run>& runs, int above, int current)
{
  const int end = int(runs.size());
  for (int a = above, b = current; a < current && b < end;) {
    const Run &p = runs[std::size_t(a)], &q = runs[std::size_t(b)];
    const int first = std::max(p.first, q.first), last = std::min(p.last, q.last);
    for (int u = first; u <= last; ++u)
      if (std::abs(upper[u] - lower[u]) <= range) {
        join(runs, a, b);
        break;
      }
    if (p.last < q.last)
      ++a;
    else
      ++b;
  }
}

// 68 % of all errors lie within, gross ones included, on KITTI (doc/stereo.md) [px].
constexpr float deviation_matched = 0.53f;
constexpr float deviation_between = 0.94f; // like ends of a gap
constexpr float deviation_beyond = 5.4f;   // behind a step, or at the border

/** \brief One row of the result. */
struct FilledRow {
  float *disparity, *deviation;

  void
  set(int u, float value, float how_sure) const
  {
    disparity[u] = value / float(kernels::disparity_steps);
    deviation[u] = value > 0.0f ? how_sure : 0.0f;
  }
};

/** \brief Fills pixels (before, after) of a row that holds something at one of the
 * two, or at both. */
void
fillGap(const std::int16_t* row, int width, int before, int after, int step,
        const FilledRow& filled)
{
  if (before < 0 || after >= width) {
    const float only = float(row[before < 0 ? after : before]);
    for (int u = before + 1; u < after; ++u)
      filled.set(u, only, deviation_beyond);
    return;
  }
  const float from = float(row[before]), to = float(row[after]);
  const bool like = std::abs(to - from) <= float(step);
  const float slope = (to - from) / float(after - before);
  for (int u = before + 1; u < after; ++u)
    filled.set(u, like ? from + slope * float(u - before) : std::min(from, to),
               like ? deviation_between : deviation_beyond);
}

void
fillRow(const std::int16_t* row, int width, int longest, int step,
        const FilledRow& filled)
{
  std::fill_n(filled.disparity, width, 0.0f);
  std::fill_n(filled.deviation, width, 0.0f);
  int before = -1; // last pixel with a disparity
  for (int u = 0; u <= width; ++u) {
    if (u < width && row[u] < 0)
      continue;
    const int gap = u - before - 1;
    if (gap > 0 && gap < width && gap <= longest)
      fillGap(row, width, before, u, step, filled);
    if (u < width)
      filled.set(u, float(row[u]), deviation_matched);
    before = u;
  }
}

} // namespace

void
removeSmallSegments(int size, int range, cv::Mat& disparity)
{
  std::vector<Run> runs;
  std::vector<int> starts; // of the runs of each row
  for (int v = 0; v < disparity.rows; ++v) {
    starts.push_back(int(runs.size()));
    const std::int16_t* const row = disparity.ptr<std::int16_t>(v);
    findRuns(row, disparity.cols, range, runs);
    if (v > 0)
      joinRows(disparity.ptr<std::int16_t>(v - 1), row, range, runs,
               starts[std::size_t(v - 1)], starts[std::size_t(v)]);
  }
  starts.push_back(int(runs.size()));
  for (int v = 0; v < disparity.rows; ++v) {
    std::int16_t* const row = disparity.ptr<std::int16_t>(v);
    for (int i = starts[std::size_t(v)]; i < starts[std::size_t(v) + 1]; ++i) {
      const Run& run = runs[std::size_t(i)];
      if (runs[std::size_t(rootOf(runs, i))].size < size)
        std::fill(row + run.first, row + run.last + 1, kernels::no_disparity);
    }
  }
}

void
smoothDisparity(int radius, int range, cv::Mat& disparity)
{
  const kernels::Smooth smooth = kernels::smoothing(simdTier());
  const int width = disparity.cols, taps = 2 * radius + 1;
  cv::Mat result(disparity.size(), CV_16SC1);
  ParallelGuard guard;
#pragma omp parallel
  guard.run([&] {
    // Of one row, with a margin that holds nothing.
    std::vector<std::int16_t> row(std::size_t(width + 2 * radius),
                                  kernels::no_disparity);
    const std::int16_t* neighbours[2 * kernels::max_smoothing + 1];
#pragma omp for schedule(static)
    for (int v = 0; v < disparity.rows; ++v) {
      for (int i = 0; i < taps; ++i)
        neighbours[i] = disparity.ptr<std::int16_t>(
            std::clamp(v + i - radius, 0, disparity.rows - 1));
      smooth(disparity.ptr<std::int16_t>(v), neighbours, taps, range, width,
             row.data() + radius);
      for (int i = 0; i < taps; ++i)
        neighbours[i] = row.data() + i;
      smooth(row.data() + radius, neighbours, taps, range, width,
             result.ptr<std::int16_t>(v));
    }
  });
  guard.rethrow();
  disparity = result;
}

DisparityImage
fillGaps(int longest, int step, const cv::Mat& disparity)
{
  DisparityImage result{cv::Mat(disparity.size(), CV_32FC1),
                        cv::Mat(disparity.size(), CV_32FC1)};
#pragma omp parallel for schedule(static)
  for (int v = 0; v < disparity.rows; ++v)
    fillRow(disparity.ptr<std::int16_t>(v), disparity.cols, longest, step,
            {result.disparity.ptr<float>(v), result.deviation.ptr<float>(v)});
  return result;
}

} // namespace pcl_semantic
