// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/cloud_features.h"
#include "support/thrown_message.h"
#include "support/tilted_street.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>

#include <random>

namespace pcl_semantic {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

TEST(CloudFeatures, HeightDistanceAndLevelOfAStreet)
{
  const TiltedStreet street(turned(4.0));
  const auto features = cloudFeatures(street.cloud, street.ground);
  ASSERT_EQ(features.size(), street.cloud.size());
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
        for (const Feature feature :
             {Feature::height, Feature::distance, Feature::level, Feature::side})
          EXPECT_TRUE(std::isnan(features[i][feature]));
        continue;
      }
      EXPECT_NEAR(features[i][Feature::height], street.heights[i], 2e-5);
      EXPECT_EQ(features[i][Feature::distance], street.cloud[i].z);
      if (!is_inside(u, v))
        continue;
      ++inside[std::size_t(surface)];
      EXPECT_NEAR(features[i][Feature::level], surface == Surface::wall ? 0.0f : 1.0f,
                  1e-3f)
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

TEST(CloudFeatures, LevelAgreesWithPlainDifferences)
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
  const auto features = cloudFeatures(cloud, ground);
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
        EXPECT_TRUE(std::isnan(features[i][Feature::level])) << u << " " << v;
        continue;
      }
      EXPECT_NEAR(features[i][Feature::level], level, 1e-3) << u << " " << v;
    }
  EXPECT_TRUE(std::isnan(features.back()[Feature::level]));
  EXPECT_EQ(features.back()[Feature::distance], 3.0f);
}

TEST(CloudFeatures, SideIsAlongTheGround)
{
  Cloud cloud(3, 2);
  for (pcl::PointXYZRGB& point : cloud)
    point.getVector3fMap() = Eigen::Vector3f(3.0f, -1.0f, 7.0f);
  cloud[4].x = -3.0f;
  const double roll = 0.2;
  const Eigen::Hyperplane<double, 3> rolled(
      Eigen::Vector3d(std::sin(roll), -std::cos(roll), 0.0), 1.5);
  const auto features = cloudFeatures(cloud, rolled);
  EXPECT_NEAR(features[0][Feature::side], 3.0 * std::cos(roll) - std::sin(roll), 1e-5);
  EXPECT_NEAR(features[4][Feature::side], 3.0 * std::cos(roll) + std::sin(roll), 1e-5);
  // Pitch does not move what is to the right.
  const Eigen::Hyperplane<double, 3> pitched(
      Eigen::Vector3d(0.0, -std::cos(roll), std::sin(roll)), 1.5);
  EXPECT_NEAR(cloudFeatures(cloud, pitched)[0][Feature::side], 3.0, 1e-5);
}

TEST(CloudFeatures, ColoursAreKnownEverywhere)
{
  Cloud cloud(2, 2); // without depth
  for (pcl::PointXYZRGB& point : cloud) {
    point.getVector3fMap().setConstant(std::numeric_limits<float>::quiet_NaN());
    point.r = 30;
    point.g = 90;
    point.b = 180;
  }
  cloud[3].r = cloud[3].g = cloud[3].b = 0;
  const auto features = cloudFeatures(cloud, {});
  EXPECT_NEAR(features[0][Feature::brightness], 100.0 / 255.0, 1e-6);
  EXPECT_NEAR(features[0][Feature::red], 0.1, 1e-6);
  EXPECT_NEAR(features[0][Feature::green], 0.3, 1e-6);
  EXPECT_EQ(features[3][Feature::brightness], 0.0f); // black has no other colour
  EXPECT_TRUE(std::isnan(features[3][Feature::red]));
  EXPECT_TRUE(std::isnan(features[3][Feature::green]));
  for (const Feature feature : {Feature::height, Feature::distance, Feature::level,
                                Feature::side, Feature::lowest, Feature::extent})
    EXPECT_TRUE(std::isnan(features[0][feature])) << nameOf(feature);
}

TEST(CloudFeatures, IsTheSameForAnyNumberOfThreads)
{
  const TiltedStreet street(turned(4.0));
  const auto values = [&](int threads) {
    setNumberOfThreads(threads);
    std::vector<float> all;
    for (const PointFeatures& each : cloudFeatures(street.cloud, street.ground))
      for (std::size_t f = 0; f < feature_count; ++f)
        all.push_back(std::isnan(each[Feature(f)]) ? -1000.0f : each[Feature(f)]);
    return all;
  };
  const std::vector<float> one = values(1);
  EXPECT_EQ(values(4), one);
  setNumberOfThreads(0);
}

TEST(CloudFeatures, RefusesCloudsThatAreNotOrganized)
{
  const Eigen::Hyperplane<double, 3> ground(Eigen::Vector3d(0, -1, 0), 1.5);
  EXPECT_TRUE(holds(thrownMessage<InvalidParameterException>(
                        [&] { cloudFeatures(Cloud(100, 1), ground); }),
                    "need an organized cloud"));
  EXPECT_TRUE(cloudFeatures(Cloud(), ground).empty());
}

} // namespace
} // namespace pcl_semantic
