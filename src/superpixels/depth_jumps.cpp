// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/superpixels/depth_jumps.h>

#include "core/cloud_size.h"
#include "core/disjoint_sets.h"
#include "core/fail.h"
#include "core/parallel_guard.h"

#include <pcl_semantic/core/no_return.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr int kNone = -1;

// A run is a sequence of connected pixels in a row; links connect runs of neighbouring
// rows.
struct Row {
  int runs = 0;
  std::vector<std::pair<int, int>> links; // run of the row above, run of this row
};

class Splitter {
public:
  Splitter(const cv::Mat& segments, const CliqueGenerator::Cloud& cloud,
           const DepthJumps& jumps)
      : segments_(segments), cloud_(cloud), has_place_(cloud),
        distance_(float(jumps.passing_distance * jumps.passing_distance)),
        near_(float(jumps.near * jumps.near)), runs_(segments.size(), CV_32SC1),
        rows_(std::size_t(segments.rows))
  {}

  SurfaceParts
  split()
  {
    ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 8)
    for (int v = 0; v < segments_.rows; ++v)
      guard.run([&] { findRuns(v); });
    guard.rethrow();
    numberRuns();
#pragma omp parallel for schedule(dynamic, 8)
    for (int v = 1; v < segments_.rows; ++v)
      guard.run([&] { linkRuns(v); });
    guard.rethrow();
    return parts();
  }

private:
  const pcl::PointXYZRGB&
  point(int u, int v) const
  {
    return cloud_[std::size_t(v) * std::size_t(segments_.cols) + std::size_t(u)];
  }

  bool
  areJoined(const pcl::PointXYZRGB& a, const pcl::PointXYZRGB& b) const
  {
    const float dx = b.x - a.x, dy = b.y - a.y, dz = b.z - a.z;
    const float length = dx * dx + dy * dy + dz * dz;
    const float cx = a.y * dz - a.z * dy, cy = a.z * dx - a.x * dz,
                cz = a.x * dy - a.y * dx;
    return length <= near_ || cx * cx + cy * cy + cz * cz >= distance_ * length;
  }

  void
  findRuns(int v)
  {
    const int* const segments = segments_.ptr<int>(v);
    int* const runs = runs_.ptr<int>(v);
    int last = kNone; // previous pixel with depth in the same segment
    int count = 0;
    for (int u = 0; u < segments_.cols; ++u) {
      if (u > 0 && segments[u] != segments[u - 1])
        last = kNone;
      runs[u] = kNone;
      if (!has_place_(point(u, v)))
        continue;
      if (last == kNone || !areJoined(point(last, v), point(u, v)))
        ++count;
      runs[u] = count - 1;
      last = u;
    }
    rows_[std::size_t(v)].runs = count;
  }

  // Converts run numbers within a row to numbers within the image.
  void
  numberRuns()
  {
    int first = 0;
    for (int v = 0; v < segments_.rows; ++v) {
      int* const runs = runs_.ptr<int>(v);
      for (int u = 0; u < segments_.cols; ++u)
        runs[u] += runs[u] == kNone ? 0 : first;
      first += rows_[std::size_t(v)].runs;
    }
    sets_.grow(std::size_t(first));
    numbers_.resize(std::size_t(first));
  }

  void
  linkRuns(int v)
  {
    const int* const runs = runs_.ptr<int>(v);
    auto& links = rows_[std::size_t(v)].links;
    for (int u = 0; u < segments_.cols; ++u) {
      if (runs[u] == kNone)
        continue;
      const int segment = segments_.at<int>(v, u);
      int above = v - 1;
      while (above >= 0 && segments_.at<int>(above, u) == segment &&
             runs_.at<int>(above, u) == kNone)
        --above;
      if (above < 0 || segments_.at<int>(above, u) != segment)
        continue;
      const std::pair<int, int> link(runs_.at<int>(above, u), runs[u]);
      if ((links.empty() || links.back() != link) &&
          areJoined(point(u, above), point(u, v)))
        links.push_back(link);
    }
  }

  SurfaceParts
  parts()
  {
    for (const Row& row : rows_)
      for (const auto& [above, run] : row.links)
        sets_.joinMembers(above, run);
    // Runs are in the order of their first pixels, and so are the first runs of the
    // parts.
    SurfaceParts result{std::move(runs_), 0};
    for (std::size_t run = 0; run < numbers_.size(); ++run) {
      const int root = sets_.rootOf(int(run));
      numbers_[run] = root == int(run) ? result.count++ : numbers_[std::size_t(root)];
    }
#pragma omp parallel for schedule(static)
    for (int v = 0; v < result.numbers.rows; ++v)
      for (int u = 0; u < result.numbers.cols; ++u)
        if (int& number = result.numbers.at<int>(v, u); number != kNone)
          number = numbers_[std::size_t(number)];
    return result;
  }

  const cv::Mat& segments_;
  const CliqueGenerator::Cloud& cloud_;
  const PlaceTest has_place_;
  float distance_, near_; // squared
  cv::Mat runs_;          // CV_32SC1
  std::vector<Row> rows_;
  DisjointSets sets_;        // of runs: the parts
  std::vector<int> numbers_; // part of each run
};

} // namespace

void
DepthJumps::validate() const
{
  for (const auto& [name, value] : {std::pair("passing distance", passing_distance),
                                    std::pair("near distance", near)})
    if (!(value >= 0.0 && value <= 1e6))
      badParameter("depth jumps: ", name, " is ", value, " m, expected 0 to 1e6");
}

SurfaceParts
splitAtDepthJumps(const cv::Mat& segments, const CliqueGenerator::Cloud& cloud,
                  const DepthJumps& jumps)
{
  jumps.validate();
  requireCloudSize(cloud);
  if (segments.type() != CV_32SC1 || segments.total() != cloud.size() ||
      segments.cols != int(cloud.width))
    badInput("depth jumps: segments of ", segments.cols, " x ", segments.rows,
             " for a cloud of ", cloud.width, " x ", cloud.height);
  return Splitter(segments, cloud, jumps).split();
}

} // namespace pcl_semantic
