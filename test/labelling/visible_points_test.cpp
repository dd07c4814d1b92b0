// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_rigs.h"

#include <pcl_semantic/labelling/visible_points.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pcl_semantic {

namespace {

using Points = std::vector<Eigen::Vector3d>;

// A return in the image.
struct Projected {
  int u = 0, v = 0;
  double z = 0.0; // 0 = outside of it
};

std::vector<Projected>
project(const Points& scan, const StereoCamera& camera)
{
  std::vector<Projected> points(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3d& p = scan[i];
    const double u = camera.fx * p.x() / p.z() + camera.cx;
    const double v = camera.fy * p.y() / p.z() + camera.cy;
    if (p.z() > 0.1 && u >= -0.5 && v >= -0.5 && u < camera.width - 0.5 &&
        v < camera.height - 0.5)
      points[i] = {int(std::floor(u + 0.5)), int(std::floor(v + 0.5)), p.z()};
  }
  return points;
}

// Whether nearer returns lie on both sides of a point's row, spelt out over all pairs.
bool
isHidden(const Projected& p, const std::vector<Projected>& points,
         const VisibilityParameters& parameters)
{
  bool above = false, below = false;
  for (const Projected& q : points)
    if (q.z > 0.0 && std::abs(q.u - p.u) <= parameters.window_columns &&
        std::abs(q.v - p.v) <= parameters.window_rows &&
        q.z < p.z - parameters.absolute_margin &&
        q.z < p.z - parameters.relative_margin * p.z) {
      above = above || q.v <= p.v;
      below = below || q.v >= p.v;
    }
  return above && below;
}

} // namespace

TEST(SeenPoints, EqualBruteForce)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> side(-15.0, 15.0), ahead(-3.0, 50.0);
  Points scan;
  for (int i = 0; i < 1500; ++i) {
    const double x = side(random), y = side(random);
    scan.emplace_back(x, y, ahead(random));
  }
  VisibilityParameters parameters;
  parameters.window_rows = 4;
  parameters.window_columns = 2;
  const std::vector<Projected> points = project(scan, smallCamera());
  const std::vector<SeenPoint> seen = seenPoints(scan, smallCamera(), parameters);
  ASSERT_EQ(seen.size(), scan.size());
  int hidden = 0, visible = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const bool is_near = points[i].z > 0.0 && points[i].z <= parameters.max_depth;
    const bool is_hidden = is_near && isHidden(points[i], points, parameters);
    hidden += is_hidden;
    visible += is_near && !is_hidden;
    ASSERT_NEAR(seen[i].depth, is_near && !is_hidden ? points[i].z : 0.0, 1e-5) << i;
    if (seen[i].depth > 0.0f) {
      ASSERT_EQ(seen[i].row, points[i].v) << i;
      ASSERT_EQ(seen[i].column, points[i].u) << i;
    }
  }
  EXPECT_GT(hidden, 20);
  EXPECT_GT(visible, 100);
  parameters.absolute_margin = 1e9; // no occlusion rule
  const std::vector<SeenPoint> all = seenPoints(scan, smallCamera(), parameters);
  const auto isSeen = [](const SeenPoint& point) { return point.depth > 0.0f; };
  EXPECT_EQ(std::count_if(all.begin(), all.end(), isSeen), hidden + visible);
}

TEST(SeenPoints, BackgroundShinesThroughOnlyBesideTheObject)
{
  // Returns as pixels with depth, scanner = camera.
  const StereoCamera camera = smallCamera();
  Points scan;
  const auto add = [&](int u, int v, double depth) {
    scan.push_back(camera.unproject(u, v, depth));
  };
  add(31, 22, 25.0);                // the wall between the beams on a car,
  add(31, 7, 25.0);                 // above its roof
  add(60, 22, 25.0);                // and beside it
  add(70, 22, 41.0);                // too far
  add(20, 10, 9.0);                 // on a pixel of the car, farther
  for (int v = 10; v <= 30; v += 5) // the car
    for (int u = 20; u <= 40; u += 2)
      add(u, v, 8.0);
  for (int v = 30; v < 50; ++v) // a road rises towards the horizon
    for (int u = 50; u < 80; ++u)
      add(u, v, 50.0 * 1.65 / (v - 25.3));
  const std::vector<SeenPoint> seen = seenPoints(scan, camera);
  EXPECT_EQ(seen[0].depth, 0.0f);
  EXPECT_EQ(seen[1].depth, 25.0f);
  EXPECT_EQ(seen[2].depth, 25.0f);
  EXPECT_EQ(seen[3].depth, 0.0f);
  EXPECT_EQ(seen[4].depth, 0.0f);
  for (std::size_t i = 5; i < seen.size(); ++i)
    EXPECT_GT(seen[i].depth, 0.0f) << i;
}

} // namespace pcl_semantic
