// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/cloud_features.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/threads.h>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pcl_semantic {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

/** \brief Surfaces of TiltedStreet. */
enum class Surface { none, ground, kerb, wall };

/** \brief A road, a pavement on its right and a wall behind that, to 40 m, seen by a
 * camera that is turned. */
struct TiltedStreet {
  static constexpr int width = 240;
  static constexpr int height = 120;
  static constexpr double camera_height = 1.65;
  static constexpr double kerb_height = 0.12;

  explicit TiltedStreet(const Eigen::Matrix3d& turn);

  pcl::PointCloud<pcl::PointXYZRGB> cloud{width, height};
  std::vector<Surface> surfaces;
  std::vector<double> heights;         // above the road
  Eigen::Hyperplane<double, 3> ground; // the truth
  std::vector<std::uint8_t> is_ground; // road and pavement
};

TiltedStreet::TiltedStreet(const Eigen::Matrix3d& turn)
    : ground(turn * Eigen::Vector3d(0, -1, 0), camera_height)
{
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const Eigen::Vector3d ray((u - 120.0) / 150.0, (v - 45.0) / 150.0, 1.0);
      const Eigen::Vector3d level_ray = turn.transpose() * ray; // x right, y down
      Surface surface = Surface::none;
      double nearest = 40.0;
      const auto meet = [&](Surface what, double depth) {
        const double x = depth * level_ray.x();
        if (depth <= 0.0 || depth >= nearest || (what == Surface::ground && x > 3.0) ||
            (what == Surface::kerb && x < 3.0))
          return;
        nearest = depth;
        surface = what;
      };
      meet(Surface::ground, camera_height / level_ray.y());
      meet(Surface::kerb, (camera_height - kerb_height) / level_ray.y());
      meet(Surface::wall, 5.0 / level_ray.x());
      pcl::PointXYZRGB& point = cloud(std::size_t(u), std::size_t(v));
      point.getVector3fMap().setConstant(std::numeric_limits<float>::quiet_NaN());
      if (surface != Surface::none)
        point.getVector3fMap() = (nearest * ray).cast<float>();
      surfaces.push_back(surface);
      heights.push_back(camera_height - nearest * level_ray.y());
      is_ground.push_back(surface == Surface::ground || surface == Surface::kerb);
    }
}

/** \brief Pitch, and half as much roll [degrees]. */
Eigen::Matrix3d
turned(double degrees)
{
  const double angle = degrees * M_PI / 180.0;
  return (Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(0.5 * angle, Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

double
degreesBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI;
}

TEST(GroundPlane, IsThatOfTheRoad)
{
  for (const double degrees : {-8.0, 0.0, 4.0}) {
    TiltedStreet street(turned(degrees));
    for (std::size_t i = 0; i < street.surfaces.size(); ++i)
      street.is_ground[i] = street.surfaces[i] == Surface::ground;
    const auto plane = fitGroundPlane(street.cloud, street.is_ground);
    ASSERT_TRUE(plane) << degrees;
    EXPECT_NEAR(plane->offset(), TiltedStreet::camera_height, 1e-5);
    EXPECT_LT(degreesBetween(plane->normal(), street.ground.normal()), 1e-3);
    EXPECT_NEAR(plane->normal().norm(), 1.0, 1e-12);
  }
}

TEST(GroundPlane, KerbsAndAThirdOfWrongPointsHardlyCount)
{
  TiltedStreet street(turned(4.0));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> chance(0.0, 1.0), lift(0.2, 2.0);
  std::size_t all = 0, wrong = 0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < street.cloud.size(); ++i) {
    if (!street.is_ground[i])
      continue;
    auto point = street.cloud[i].getVector3fMap();
    ++all;
    if (chance(random) < 0.34) {
      ++wrong;
      point += (lift(random) * street.ground.normal()).cast<float>();
    }
    const Eigen::Vector3d row(point.x(), point.z(), 1.0);
    normal += row * row.transpose();
    right += point.y() * row;
  }
  ASSERT_GT(3 * wrong, all);
  const auto plane = fitGroundPlane(street.cloud, street.is_ground);
  ASSERT_TRUE(plane);
  EXPECT_NEAR(plane->offset(), TiltedStreet::camera_height, 0.02);
  EXPECT_LT(degreesBetween(plane->normal(), street.ground.normal()), 0.3);
  // Plain least squares are far off.
  const Eigen::Vector3d squares = normal.ldlt().solve(right);
  EXPECT_LT(squares[2], TiltedStreet::camera_height - 0.2);
}

TEST(GroundPlane, FarPointsDoNotCount)
{
  TiltedStreet street(turned(0.0));
  std::size_t far = 0;
  for (pcl::PointXYZRGB& point : street.cloud)
    if (point.z > 15.0f) {
      point.y -= 0.05f * (point.z - 15.0f);
      ++far;
    }
  ASSERT_GT(far, 100u);
  for (std::size_t i = 0; i < street.surfaces.size(); ++i)
    street.is_ground[i] = street.surfaces[i] == Surface::ground;
  const auto near = fitGroundPlane(street.cloud, street.is_ground, 15.0);
  ASSERT_TRUE(near);
  EXPECT_LT(degreesBetween(near->normal(), street.ground.normal()), 1e-3);
  const auto all = fitGroundPlane(street.cloud, street.is_ground, 40.0);
  ASSERT_TRUE(all);
  EXPECT_GT(degreesBetween(all->normal(), street.ground.normal()), 1e-2);
}

TEST(GroundPlane, TooFewPointsOrTooSteepAreNone)
{
  TiltedStreet street(turned(0.0));
  std::size_t count = 0;
  for (std::size_t i = 0; i < street.cloud.size(); ++i)
    street.is_ground[i] = street.surfaces[i] == Surface::ground &&
                          street.cloud[i].z < 20.0f && count++ < 200;
  EXPECT_TRUE(fitGroundPlane(street.cloud, street.is_ground));
  *std::find(street.is_ground.begin(), street.is_ground.end(), 1) = 0;
  EXPECT_FALSE(fitGroundPlane(street.cloud, street.is_ground));
  EXPECT_FALSE(fitGroundPlane({}, {}));

  const auto is_there = [](double degrees) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitX())
            .toRotationMatrix();
    const TiltedStreet steep(turn);
    EXPECT_GT(std::count(steep.is_ground.begin(), steep.is_ground.end(), 1), 1000);
    return fitGroundPlane(steep.cloud, steep.is_ground).has_value();
  };
  EXPECT_TRUE(is_there(25.0));
  EXPECT_FALSE(is_there(35.0));
}

TEST(GroundPlane, RefusesOtherSizes)
{
  const TiltedStreet street(turned(0.0));
  expectBadParameter("2 flags for 28800 points", [&] {
    fitGroundPlane(street.cloud, {1, 0});
  });
}

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
  // Pitch does not move points to the right.
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
  for (const Feature feature :
       {Feature::height, Feature::distance, Feature::level, Feature::side})
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
  expectBadParameter("need an organized cloud",
                     [&] { cloudFeatures(Cloud(100, 1), ground); });
  EXPECT_TRUE(cloudFeatures(Cloud(), ground).empty());
}

} // namespace
} // namespace pcl_semantic
