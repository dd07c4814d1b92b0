// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/object_extraction.h>

#include "core/fail.h"

#include <pcl_semantic/things/connected_points.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pcl_semantic {

namespace {

// The lowest point of a group, by z, y, x; then the label.
using Rank = std::tuple<double, double, double, Label>;

Rank
rankOf(const Eigen::Vector3d& position, Label label)
{
  return {position.z(), position.y(), position.x(), label};
}

} // namespace

void
ObjectExtractionBase::setLabelSet(const LabelSet& label_set)
{
  std::vector<double> gaps(256, 0.0);
  bool has_things = false;
  for (int label = 1; label <= label_set.size(); ++label) {
    const LabelClass& each = label_set[Label(label)];
    if (!each.thing)
      continue;
    gaps[std::size_t(label)] = each.gap > 0.0 ? each.gap : HUGE_VAL;
    has_things = true;
  }
  if (!has_things)
    badParameter("no class of the label set is marked thing");
  gaps_ = gaps;
}

void
ObjectExtractionBase::setGap(double gap)
{
  if (!(gap > 0.0 && std::isfinite(gap)))
    badParameter("gap of objects: ", gap, " m, expected a positive number");
  gap_ = gap;
}

std::vector<pcl::PointIndices>
ObjectExtractionBase::group(std::vector<Point> points) const
{
  std::stable_sort(points.begin(), points.end(),
                   [](const Point& a, const Point& b) { return a.label < b.label; });
  std::vector<std::pair<Rank, pcl::PointIndices>> found;
  for (auto first = points.begin(); first != points.end();) {
    const Label label = first->label;
    const auto last = std::find_if(
        first, points.end(), [&](const Point& each) { return each.label != label; });
    std::vector<Eigen::Vector3d> positions;
    for (auto point = first; point != last; ++point)
      positions.push_back(point->position);
    const double gap = std::isinf(gaps_[label]) ? gap_ : gaps_[label];
    const std::vector<int> components = connectedComponents(positions, gap);
    const std::size_t before = found.size();
    for (std::size_t i = 0; i < components.size(); ++i) {
      const std::size_t object = before + std::size_t(components[i]);
      const Rank rank = rankOf(positions[i], label);
      if (object >= found.size())
        found.resize(object + 1, {{HUGE_VAL, 0.0, 0.0, label}, {}});
      found[object].first = std::min(found[object].first, rank);
      found[object].second.indices.push_back(first[std::ptrdiff_t(i)].index);
    }
    first = last;
  }
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<pcl::PointIndices> objects;
  for (auto& [rank, object] : found)
    if (object.indices.size() >= min_size_)
      objects.push_back(std::move(object));
  return objects;
}

} // namespace pcl_semantic
