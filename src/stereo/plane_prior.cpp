// SPDX-License-Identifier: BSD-3-Clause
#include "plane_prior.h"
#include "delaunay.h"

#include <algorithm>

namespace pcl_semantic {

PlanePrior::PlanePrior(std::vector<SupportPoint> points, int width, int height,
                       int disparities)
    : width_(width), columns_((width + cell_size - 1) / cell_size),
      rows_((height + cell_size - 1) / cell_size), bytes_(disparities / 8),
      seen_(std::size_t(columns_ * rows_ * bytes_), 0)
{
  markSeen(points);
  addCorners(width, height, points);
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.u != b.u ? a.u < b.u : a.v < b.v;
  });
  std::vector<GridPoint> positions;
  positions.reserve(points.size());
  for (const SupportPoint& point : points)
    positions.push_back({point.u, point.v});
  const auto corners = triangulate(positions);
  triangles_.reserve(corners.size());
  for (const auto& [a, b, c] : corners)
    addTriangle(points[std::size_t(a)], points[std::size_t(b)], points[std::size_t(c)]);
}

void
PlanePrior::markSeen(const std::vector<SupportPoint>& points)
{
  for (const SupportPoint& point : points) {
    const int d =
        (point.disparity + kernels::disparity_steps / 2) / kernels::disparity_steps;
    const int column = point.u / cell_size, row = point.v / cell_size;
    // Near includes half a cell beyond the border.
    for (int y = std::max(row - 1, 0); y <= std::min(row + 1, rows_ - 1); ++y)
      for (int x = std::max(column - 1, 0); x <= std::min(column + 1, columns_ - 1);
           ++x) {
        std::uint8_t& bits = seen_[std::size_t((y * columns_ + x) * bytes_ + d / 8)];
        bits = std::uint8_t(bits | 1 << d % 8);
      }
  }
}

void
PlanePrior::addTriangle(const SupportPoint& a, const SupportPoint& b,
                        const SupportPoint& c)
{
  std::array<const SupportPoint*, 3> by_row = {&a, &b, &c};
  std::sort(by_row.begin(), by_row.end(),
            [](const auto* p, const auto* q) { return p->v < q->v; });
  Triangle triangle;
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.u[i] = by_row[i]->u;
    triangle.v[i] = by_row[i]->v;
  }
  const float u1 = float(b.u - a.u), v1 = float(b.v - a.v);
  const float u2 = float(c.u - a.u), v2 = float(c.v - a.v);
  const float d1 = float(b.disparity - a.disparity);
  const float d2 = float(c.disparity - a.disparity);
  const float area = u1 * v2 - u2 * v1; // of a triangle: not 0
  triangle.along_u = (d1 * v2 - d2 * v1) / area;
  triangle.along_v = (d2 * u1 - d1 * u2) / area;
  triangle.at_zero = float(a.disparity) - triangle.along_u * float(a.u) -
                     triangle.along_v * float(a.v);
  const auto slope = [&](std::size_t from, std::size_t to) {
    const int rise = triangle.v[to] - triangle.v[from];
    return rise == 0 ? 0.0f : float(triangle.u[to] - triangle.u[from]) / float(rise);
  };
  triangle.long_edge = slope(0, 2);
  triangle.upper_edge = slope(0, 1);
  triangle.lower_edge = slope(1, 2);
  triangles_.push_back(triangle);
}

void
PlanePrior::fillRows(int begin, int end, std::vector<std::int16_t>& expected) const
{
  // Pixels on an edge belong to both triangles, whose planes agree there.
  constexpr float on_edge = 1e-3f;
  expected.assign(std::size_t(width_) * std::size_t(end - begin),
                  kernels::no_disparity);
  const int largest = bytes_ * 8 * kernels::disparity_steps - 1;
  for (const Triangle& t : triangles_)
    for (int v = std::max(begin, t.v[0]); v < end && v <= t.v[2]; ++v) {
      const float one = float(t.u[0]) + t.long_edge * float(v - t.v[0]);
      const float other = v < t.v[1] || t.v[1] == t.v[2]
                              ? float(t.u[0]) + t.upper_edge * float(v - t.v[0])
                              : float(t.u[1]) + t.lower_edge * float(v - t.v[1]);
      const float first = std::min(one, other) - on_edge;
      const int last = int(std::max(one, other) + on_edge);
      std::int16_t* const row =
          expected.data() + std::size_t(v - begin) * std::size_t(width_);
      const float at_row = t.at_zero + t.along_v * float(v) + 0.5f;
      for (int u = int(first) + (float(int(first)) < first); u <= last; ++u) {
        const int value = int(at_row + t.along_u * float(u));
        row[u] = std::int16_t(std::clamp(value, 0, largest));
      }
    }
}

std::vector<SupportPoint>
seenFromRight(const std::vector<SupportPoint>& points)
{
  std::vector<SupportPoint> result = points;
  for (SupportPoint& point : result)
    point.u -=
        (point.disparity + kernels::disparity_steps / 2) / kernels::disparity_steps;
  std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) {
    return a.v != b.v ? a.v < b.v : a.u != b.u ? a.u < b.u : a.disparity > b.disparity;
  });
  const auto same = [](const auto& a, const auto& b) {
    return a.u == b.u && a.v == b.v;
  };
  result.erase(std::unique(result.begin(), result.end(), same), result.end());
  return result;
}

} // namespace pcl_semantic
