/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "support/thrown_message.h"
#include "support/tilted_street.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/stereo/cloud_geometry.h>

#include <gtest/gtest.h>

#include <random>

namespace pcl_semantic {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

TEST(CloudGeometry, HeightDistanceAndLevelOfAStreet)
{
  const TiltedStreet street(turned(4.0));
  const auto geometry = cloudGeometry(street.cloud, street.ground);
  ASSERT_EQ(geometry.size(), street.cloud.size());
  // Whether all pixels that the normal is made of are of one surface.
  const auto is_inside = [&](int u, int v) {
    for (int y = v - 8; y <= v + 8; ++y)
      for (int x = u - 8; x <= u + 8; ++x)
        if (x < 0 || y < 0 || x >= TiltedStreet::width || y >= TiltedStreet::height ||
            street.surfaces[std::size_t(y * TiltedStreet::width + x)] !=
                street.surfaces[std::size_t(v * TiltedStreet::width + u)])
          return false;
    return true;
  };
  std::array<int, 4> inside{};
  for (int v = 0; v < TiltedStreet::height; ++v)
    for (int u = 0; u < TiltedStreet::width; ++u) {
      const auto i = std::size_t(v * TiltedStreet::width + u);
      const Surface surface = street.surfaces[i];
      if (surface == Surface::none) {
        EXPECT_TRUE(std::isnan(geometry[i].height) &&
                    std::isnan(geometry[i].distance) && std::isnan(geometry[i].level));
        continue;
      }
      EXPECT_NEAR(geometry[i].height, street.heights[i], 2e-5);
      EXPECT_EQ(geometry[i].distance, street.cloud[i].z);
      if (!is_inside(u, v))
        continue;
      ++inside[std::size_t(surface)];
      EXPECT_NEAR(geometry[i].level, surface == Surface::wall ? 0.0f : 1.0f, 1e-3f)
          << u << " " << v;
    }
  EXPECT_GT(inside[std::size_t(Surface::ground)], 1000);
  EXPECT_GT(inside[std::size_t(Surface::wall)], 1000);
}

// The mean of the points there are, seven by seven pixels; NaN if there are none.
Eigen::Vector3d
plainMean(const Cloud& cloud, int u, int v)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (int y = std::max(v - 3, 0); y <= std::min(v + 3, int(cloud.height) - 1); ++y)
    for (int x = std::max(u - 3, 0); x <= std::min(u + 3, int(cloud.width) - 1); ++x)
      if (std::isfinite(cloud(std::size_t(x), std::size_t(y)).z)) {
        sum += cloud(std::size_t(x), std::size_t(y)).getVector3fMap().cast<double>();
        count += 1.0;
      }
  return sum / count;
}

TEST(CloudGeometry, LevelAgreesWithPlainDifferences)
{
  Cloud cloud(40, 30);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(-3.0f, 3.0f), chance(0.0f, 1.0f);
  for (std::size_t v = 0; v < 30; ++v)
    for (std::size_t u = 0; u < 40; ++u)
      cloud(u, v).getVector3fMap() =
          chance(random) < 0.3f || u > 24
              ? Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN())
              : Eigen::Vector3f(0.3f * float(u) + place(random), place(random),
                                5.0f + 0.2f * float(v) + place(random));
  cloud(39, 29).getVector3fMap() = Eigen::Vector3f(1, 2, 3); // alone
  const Eigen::Hyperplane<double, 3> ground(
      Eigen::Vector3d(0.1, -1.0, 0.2).normalized(), 1.5);
  const auto geometry = cloudGeometry(cloud, ground);
  for (int v = 0; v < 30; ++v)
    for (int u = 0; u < 40; ++u) {
      const auto i = std::size_t(v * 40 + u);
      if (!std::isfinite(cloud[i].z))
        continue;
      const Eigen::Vector3d normal =
          (plainMean(cloud, std::min(u + 5, 39), v) -
           plainMean(cloud, std::max(u - 5, 0), v))
              .cross(plainMean(cloud, u, std::min(v + 5, 29)) -
                     plainMean(cloud, u, std::max(v - 5, 0)));
      const double level = std::abs(normal.normalized().dot(ground.normal()));
      if (std::isnan(level)) {
        EXPECT_TRUE(std::isnan(geometry[i].level)) << u << " " << v;
        continue;
      }
      EXPECT_NEAR(geometry[i].level, level, 1e-3) << u << " " << v;
    }
  EXPECT_TRUE(std::isnan(geometry.back().level));
  EXPECT_EQ(geometry.back().distance, 3.0f);
}

TEST(CloudGeometry, IsTheSameForAnyNumberOfThreads)
{
  const TiltedStreet street(turned(4.0));
  const auto values = [&](int threads) {
    setNumberOfThreads(threads);
    std::vector<float> all;
    for (const PointGeometry& each : cloudGeometry(street.cloud, street.ground))
      for (const float value : {each.height, each.distance, each.level})
        all.push_back(std::isnan(value) ? -1000.0f : value);
    return all;
  };
  const std::vector<float> one = values(1);
  EXPECT_EQ(values(4), one);
  setNumberOfThreads(0);
}

TEST(CloudGeometry, RefusesCloudsThatAreNotOrganized)
{
  const Eigen::Hyperplane<double, 3> ground(Eigen::Vector3d(0, -1, 0), 1.5);
  EXPECT_TRUE(holds(thrownMessage<InvalidParameterException>(
                        [&] { cloudGeometry(Cloud(100, 1), ground); }),
                    "need an organized cloud"));
  EXPECT_TRUE(cloudGeometry(Cloud(), ground).empty());
}

} // namespace
} // namespace pcl_semantic
