// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/plane_prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>

namespace pcl_semantic {
namespace {

constexpr int width = 133, height = 71, disparities = 64;

std::vector<SupportPoint>
pointsOn(const std::function<double(int, int)>& surface)
{
  // Includes the corners: points added there have the disparity of the nearest point.
  std::vector<SupportPoint> points;
  for (const int v : {0, height - 1})
    for (const int u : {0, width - 1})
      points.push_back({u, v, int(std::lround(surface(u, v)))});
  std::mt19937 random(4);
  for (int v = 5; v < height - 1; v += 5)
    for (int u = 5; u < width - 1; u += 5)
      if (random() % 3 != 0)
        points.push_back({u, v, int(std::lround(surface(u, v)))});
  return points;
}

TEST(PlanePrior, ExpectsThePlaneThroughThePoints)
{
  const std::function<double(int, int)> planes[] = {
      [](int, int) { return 400.0; }, [](int u, int) { return 100.0 + 3.0 * u; },
      [](int, int v) { return 200.0 + 5.0 * v; },
      [](int u, int v) { return 500.0 - 2.0 * u + 4.0 * v; }};
  for (const auto& plane : planes) {
    const PlanePrior prior(pointsOn(plane), width, height, disparities);
    for (const auto& [begin, end] : {std::pair(0, height), {17, 33}, {70, 71}}) {
      std::vector<std::int16_t> expected;
      prior.fillRows(begin, end, expected);
      ASSERT_EQ(expected.size(), std::size_t((end - begin) * width));
      for (int v = begin; v < end; ++v)
        for (int u = 0; u < width; ++u)
          ASSERT_NEAR(expected[std::size_t((v - begin) * width + u)], plane(u, v), 1.0)
              << u << " " << v;
    }
  }
}

TEST(PlanePrior, StaysWithinTheRange)
{
  constexpr double largest = (disparities - 1) * kernels::disparity_steps + 7;
  const PlanePrior prior(
      pointsOn([](int u, int v) { return (u / 7 + v / 9) % 2 ? 0.0 : largest; }), width,
      height, disparities);
  std::vector<std::int16_t> expected;
  prior.fillRows(0, height, expected);
  for (const int value : expected)
    ASSERT_TRUE(value >= 0 && value < disparities * kernels::disparity_steps) << value;
}

TEST(PlanePrior, NearAreTheCellsAround)
{
  const int d = 13, u = 47, v = 22;
  const PlanePrior prior({{u, v, d * kernels::disparity_steps + 3},
                          {5, 65, 20 * kernels::disparity_steps},
                          {120, 65, 20 * kernels::disparity_steps}},
                         width, height, disparities);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::uint8_t* const cell =
          prior.seen(y) + x / PlanePrior::cell_size * (disparities / 8);
      const bool near = std::abs(x / PlanePrior::cell_size - 4) <= 1 &&
                        std::abs(y / PlanePrior::cell_size - 2) <= 1;
      ASSERT_EQ(cell[d / 8] >> d % 8 & 1, int(near)) << x << " " << y;
    }
}

TEST(PlanePrior, TheRightImageKeepsTheNearerOfTwoPoints)
{
  constexpr int step = kernels::disparity_steps;
  const auto seen =
      seenFromRight({{50, 10, 20 * step}, {40, 10, 10 * step + 2}, {60, 10, 5 * step}});
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].u, 30);
  EXPECT_EQ(seen[0].disparity, 20 * step);
  EXPECT_EQ(seen[1].u, 55);
}

TEST(SupportPoints, CornersTakeTheNearest)
{
  std::vector<SupportPoint> points = {{10, 10, 100}, {120, 60, 200}};
  addCorners(width, height, points);
  ASSERT_EQ(points.size(), 6u);
  for (std::size_t i = 2; i < 6; ++i) {
    const SupportPoint& corner = points[i];
    EXPECT_TRUE(corner.u == 0 || corner.u == width - 1);
    EXPECT_TRUE(corner.v == 0 || corner.v == height - 1);
    EXPECT_EQ(corner.disparity, corner.u == 0 ? 100 : 200);
  }
}

} // namespace
} // namespace pcl_semantic
