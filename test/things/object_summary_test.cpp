// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/object_summary.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pcl_semantic {

namespace {

// The smallest area of a rectangle around the points, among 9000 directions.
double
plainArea(const std::vector<Eigen::Vector3d>& points)
{
  double best = HUGE_VAL;
  for (int step = 0; step < 9000; ++step) {
    const double angle = step * M_PI / 18000.0;
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle));
    Eigen::AlignedBox2d extent;
    for (const Eigen::Vector3d& point : points)
      extent.extend(Eigen::Vector2d(along.dot(point.head<2>()),
                                    along.x() * point.y() - along.y() * point.x()));
    best = std::min(best, extent.sizes().prod());
  }
  return best;
}

} // namespace

TEST(SmallestBox, FindsATurnedBox)
{
  for (const double yaw : {-1.5, -0.7, 0.0, 0.3, 1.2}) {
    std::vector<Eigen::Vector3d> points;
    const Eigen::AngleAxisd turn(yaw, Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d centre(10, -4, 1);
    for (const double scale : {0.3, 1.0})
      for (const double x : {-2.0, 2.0})
        for (const double y : {-0.8, 0.8})
          points.push_back(centre +
                           scale * (turn * Eigen::Vector3d(x, y, x < 0 ? -0.7 : 0.7)));
    const YawBox box = smallestBox(points);
    EXPECT_TRUE(box.size.isApprox(Eigen::Vector3d(4.0, 1.6, 1.4), 1e-9));
    EXPECT_TRUE(box.centre.isApprox(centre, 1e-9));
    EXPECT_NEAR(box.yaw, yaw, 1e-9);
  }
}

TEST(SmallestBox, IsNoLargerThanAnyOtherAndContainsAllPoints)
{
  std::mt19937 random(6);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 40; ++i)
      points.emplace_back(3.0 * normal(random) + 5.0, normal(random), normal(random));
    const YawBox box = smallestBox(points);
    EXPECT_LE(box.size.x() * box.size.y(), plainArea(points) + 1e-9);
    EXPECT_GE(box.size.x(), box.size.y());
    const Eigen::AngleAxisd back(-box.yaw, Eigen::Vector3d::UnitZ());
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Array3d inside = back * (point - box.centre);
      EXPECT_TRUE((inside.abs() <= 0.5 * box.size.array() + 1e-9).all());
    }
    Eigen::AlignedBox3d corners;
    for (const Eigen::Vector3d& corner : box.corners())
      corners.extend(back * (corner - box.centre));
    EXPECT_TRUE(corners.sizes().isApprox(box.size, 1e-9));
  }
}

TEST(SummarizeObject, AcceptsAPointAndALine)
{
  const ObjectSummary one = summarizeObject({{1, 2, 3}});
  EXPECT_EQ(one.points, 1u);
  EXPECT_TRUE(one.yaw_box.centre.isApprox(Eigen::Vector3d(1, 2, 3)));
  EXPECT_TRUE(one.yaw_box.size.isZero());
  const ObjectSummary line = summarizeObject({{0, 0, 0}, {1, 1, 0}, {2, 2, 2}});
  EXPECT_TRUE(line.centre.isApprox(Eigen::Vector3d(1, 1, 2.0 / 3.0)));
  EXPECT_NEAR(line.yaw_box.size.x(), std::sqrt(8.0), 1e-12);
  EXPECT_NEAR(line.yaw_box.size.y(), 0.0, 1e-12);
  EXPECT_NEAR(line.yaw_box.yaw, M_PI / 4.0, 1e-12);
  EXPECT_TRUE(line.box.max().isApprox(Eigen::Vector3d(2, 2, 2)));
}

} // namespace pcl_semantic
