// SPDX-License-Identifier: BSD-3-Clause
#include "stereo/ground_plane.h"
#include "support/thrown_message.h"
#include "support/tilted_street.h"

#include <pcl_semantic/core/exceptions.h>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pcl_semantic {
namespace {

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
  EXPECT_TRUE(holds(thrownMessage<InvalidParameterException>([&] {
                      fitGroundPlane(street.cloud, {1, 0});
                    }),
                    "2 flags for 28800 points"));
}

} // namespace
} // namespace pcl_semantic
