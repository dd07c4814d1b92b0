// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/delaunay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pcl_semantic {
namespace {

std::int64_t
twiceArea(const GridPoint& a, const GridPoint& b, const GridPoint& c)
{
  return std::int64_t(b.u - a.u) * (c.v - a.v) - std::int64_t(b.v - a.v) * (c.u - a.u);
}

// Squared distance to the circumcentre against the squared radius, in long double.
bool
liesInCircle(const GridPoint& a, const GridPoint& b, const GridPoint& c,
             const GridPoint& d)
{
  using Real = long double;
  const Real bu = b.u - a.u, bv = b.v - a.v, cu = c.u - a.u, cv = c.v - a.v;
  const Real twice = 2 * (bu * cv - bv * cu);
  const Real b2 = bu * bu + bv * bv, c2 = cu * cu + cv * cv;
  const Real u = (cv * b2 - bv * c2) / twice, v = (bu * c2 - cu * b2) / twice;
  const Real du = d.u - a.u - u, dv = d.v - a.v - v;
  return du * du + dv * dv < (u * u + v * v) * (1 - 1e-12L);
}

// No point in any circle, and the triangles fill the hull: that is what Delaunay means.
void
expectDelaunay(std::vector<GridPoint> points, std::int64_t twice_hull)
{
  std::sort(points.begin(), points.end(), [](const GridPoint& a, const GridPoint& b) {
    return a.u != b.u ? a.u < b.u : a.v < b.v;
  });
  const auto triangles = triangulate(points);
  std::int64_t sum = 0;
  for (const auto& [i, j, k] : triangles) {
    const GridPoint &a = points[std::size_t(i)], &b = points[std::size_t(j)],
                    &c = points[std::size_t(k)];
    const std::int64_t area = twiceArea(a, b, c);
    ASSERT_GT(area, 0);
    sum += area;
    for (const GridPoint& d : points)
      ASSERT_FALSE(liesInCircle(a, b, c, d));
  }
  EXPECT_EQ(sum, twice_hull);
}

TEST(Delaunay, RandomPointsWithinASquare)
{
  std::mt19937 random(3);
  for (const int size : {12, 100, 16000}) {
    std::vector<GridPoint> points = {{0, 0}, {size, 0}, {0, size}, {size, size}};
    for (int i = 0; i < 300; ++i)
      points.push_back(
          {int(random() % unsigned(size)), int(random() % unsigned(size))});
    std::sort(points.begin(), points.end(), [](const GridPoint& a, const GridPoint& b) {
      return a.u != b.u ? a.u < b.u : a.v < b.v;
    });
    points.erase(std::unique(points.begin(), points.end(),
                             [](const GridPoint& a, const GridPoint& b) {
                               return a.u == b.u && a.v == b.v;
                             }),
                 points.end());
    expectDelaunay(points, 2 * std::int64_t(size) * size);
  }
}

TEST(Delaunay, AGridWhereAllCirclesHoldFourPoints)
{
  std::vector<GridPoint> points;
  for (int u = 0; u <= 15; ++u)
    for (int v = 0; v <= 10; ++v)
      points.push_back({5 * u, 5 * v});
  expectDelaunay(points, 2 * 75 * 50);
}

TEST(Delaunay, PointsOnALineHaveNoTriangles)
{
  EXPECT_TRUE(triangulate({}).empty());
  EXPECT_TRUE(triangulate({{1, 2}}).empty());
  EXPECT_TRUE(triangulate({{1, 2}, {3, 4}}).empty());
  std::vector<GridPoint> points;
  for (int i = 0; i < 37; ++i)
    points.push_back({2 * i, i});
  EXPECT_TRUE(triangulate(points).empty());
  points.push_back({80, 0});
  EXPECT_EQ(triangulate(points).size(), 36u);
}

} // namespace
} // namespace pcl_semantic
