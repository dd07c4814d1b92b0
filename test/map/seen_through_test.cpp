// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/map/seen_through.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <vector>

namespace {

using namespace pcl_semantic;
using Cloud = pcl::PointCloud<pcl::PointXYZRGB>;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr double voxel_size = 0.1;

StereoCamera
camera()
{
  StereoCamera camera;
  camera.fx = camera.fy = 100.0;
  camera.cx = 30.0;
  camera.cy = 20.0;
  camera.baseline = 0.5;
  camera.width = 61;
  camera.height = 41;
  return camera;
}

// The pixels of an image at the depths that a function gives; NaN = none.
template <typename Depth>
Cloud
cloudOf(Depth&& depth)
{
  const StereoCamera view = camera();
  Cloud cloud(std::uint32_t(view.width), std::uint32_t(view.height));
  for (int v = 0; v < view.height; ++v)
    for (int u = 0; u < view.width; ++u)
      cloud(std::size_t(u), std::size_t(v)).getVector3fMap() =
          view.unproject(u, v, double(depth(u, v))).cast<float>();
  return cloud;
}

Eigen::Isometry3d
somePose()
{
  Eigen::Isometry3d pose(
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.2, 1.0, -0.1).normalized()));
  pose.translation() = Eigen::Vector3d(3.03, -1.71, 0.52);
  return pose;
}

// By the text of eraseSeenThrough, with all pixels asked for each voxel.
std::vector<bool>
plainlyErased(const Cloud& cloud, const Eigen::Isometry3d& pose, double share)
{
  const StereoCamera view = camera();
  using Key = std::tuple<long, long, long>;
  std::map<Key, std::vector<std::size_t>> points_of;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (std::isfinite(cloud[i].z)) {
      const Eigen::Vector3d p =
          pose * cloud[i].getVector3fMap().cast<double>() / voxel_size;
      points_of[{std::lround(std::floor(p.x())), std::lround(std::floor(p.y())),
                 std::lround(std::floor(p.z()))}]
          .push_back(i);
    }
  std::vector<bool> erased(cloud.size());
  for (const auto& [key, points] : points_of) {
    const Eigen::Vector3d low(double(std::get<0>(key)), double(std::get<1>(key)),
                              double(std::get<2>(key)));
    std::vector<double> us, vs;
    for (int x : {0, 1})
      for (int y : {0, 1})
        for (int z : {0, 1}) {
          const Eigen::Vector2d pixel = view.project(
              pose.inverse() * ((low + Eigen::Vector3d(x, y, z)) * voxel_size));
          us.push_back(pixel.x());
          vs.push_back(pixel.y());
        }
    const auto [u0, u1] = std::minmax_element(us.begin(), us.end());
    const auto [v0, v1] = std::minmax_element(vs.begin(), vs.end());
    const double z =
        (pose.inverse() * Eigen::Vector3d((low.array() + 0.5) * voxel_size)).z();
    int beyond = 0;
    for (int v = 0; v < view.height; ++v)
      for (int u = 0; u < view.width; ++u)
        beyond +=
            u >= *u0 && u <= *u1 && v >= *v0 && v <= *v1 &&
            cloud(std::size_t(u), std::size_t(v)).z > z + 0.5 + z * voxel_size / 2.0;
    const double hits = double(points.size());
    if (hits / (hits + beyond) < share)
      for (const std::size_t i : points)
        erased[i] = true;
  }
  return erased;
}

TEST(SeenThrough, EqualsAPlainCount)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> depth(2.0, 6.0);
  // Patches of different depths, and pixels without.
  const Cloud cloud = cloudOf([&, last = 3.0](int u, int v) mutable {
    if (random() % 4 == 0)
      last = depth(random);
    return (u * 7 + v * 3) % 11 == 0 ? double(nan) : last;
  });
  std::size_t some = 0;
  for (const double share : {0.1, 0.33, 0.8}) {
    Cloud rest = cloud;
    const std::size_t count =
        eraseSeenThrough(rest, camera(), somePose(), voxel_size, share);
    const std::vector<bool> expected = plainlyErased(cloud, somePose(), share);
    EXPECT_EQ(count, std::size_t(std::count(expected.begin(), expected.end(), true)));
    for (std::size_t i = 0; i < cloud.size(); ++i)
      EXPECT_EQ(std::isnan(rest[i].z), expected[i] || std::isnan(cloud[i].z)) << i;
    EXPECT_GT(count, some); // the larger the share the more
    some = count;
  }
  EXPECT_LT(some, cloud.size());
}

TEST(SeenThrough, TheRimOfAPostGoesAndThePostStays)
{
  // A post of 0.4 m fills four columns of voxels, 5 px each, and one pixel of a fifth
  // is wrongly as near; 10 m behind it is a wall.
  const auto depth = [](int u, int) { return u >= 30 && u <= 50 ? 2.05 : 12.0; };
  Cloud cloud = cloudOf(depth);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().x() = 0.0025; // keeps pixel centres off the walls of voxels
  const Cloud before = cloud;
  const std::size_t count = eraseSeenThrough(cloud, camera(), pose, voxel_size, 0.33);
  EXPECT_GT(count, 0u);
  for (int v = 0; v < camera().height; ++v)
    for (int u = 0; u < camera().width; ++u) {
      const auto& point = before(std::size_t(u), std::size_t(v));
      const bool is_rim = u <= 50 && u >= 30 && pose.translation().x() + point.x > 0.4;
      EXPECT_EQ(std::isnan(cloud(std::size_t(u), std::size_t(v)).z), is_rim) << u;
    }
}

TEST(SeenThrough, TheGroundStays)
{
  // A camera 1.65 m above a ground that it sees from 8 m on.
  const StereoCamera view = camera();
  Cloud cloud = cloudOf([&](int, int v) {
    return v <= 20 ? double(nan) : view.fy * 1.65 / (v - view.cy);
  });
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (const double height : {0.01, 0.05, 0.09}) { // of the ground within its voxel
    pose.translation() = Eigen::Vector3d(0.013, -1.65 + height, 0.017);
    EXPECT_EQ(eraseSeenThrough(cloud, view, pose, voxel_size, 0.33), 0u) << height;
  }
}

TEST(SeenThrough, PixelsWithoutDepthSayNothing)
{
  const auto pixel = [](double behind) {
    return cloudOf([=](int u, int v) { return u == 30 && v == 20 ? 2.05 : behind; });
  };
  Cloud beside_nothing = pixel(double(nan)), beside_a_wall = pixel(12.0);
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  EXPECT_EQ(eraseSeenThrough(beside_nothing, camera(), pose, voxel_size, 1.0), 0u);
  EXPECT_EQ(eraseSeenThrough(beside_a_wall, camera(), pose, voxel_size, 0.1), 1u);
  Cloud nothing = pixel(12.0);
  EXPECT_EQ(eraseSeenThrough(nothing, camera(), pose, voxel_size, 0.0), 0u);
}

TEST(SeenThrough, ThreadsDoNotMatter)
{
  std::mt19937 random(2);
  const Cloud cloud =
      cloudOf([&](int, int) { return 2.0 + 0.1 * double(random() % 40); });
  std::vector<Cloud> results(2, cloud);
  for (int k = 0; k < 2; ++k) {
    setNumberOfThreads(1 + 2 * k);
    eraseSeenThrough(results[std::size_t(k)], camera(), somePose(), voxel_size, 0.5);
  }
  setNumberOfThreads(0);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    EXPECT_EQ(std::isnan(results[0][i].x), std::isnan(results[1][i].x));
}

TEST(SeenThrough, RefusesWhatDoesNotFit)
{
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Cloud cloud = cloudOf([](int, int) { return 2.0; });
  Cloud other(5, 4);
  EXPECT_THROW(eraseSeenThrough(other, camera(), pose, voxel_size, 0.3),
               InvalidParameterException);
  for (const double share : {-0.1, 1.1, double(nan)})
    EXPECT_THROW(eraseSeenThrough(cloud, camera(), pose, voxel_size, share),
                 InvalidParameterException);
  for (const double size : {0.0, -1.0, double(nan)})
    EXPECT_THROW(eraseSeenThrough(cloud, camera(), pose, size, 0.3),
                 InvalidParameterException);
  Eigen::Isometry3d nowhere = pose, scaled = pose;
  nowhere.translation().x() = double(nan);
  scaled.linear() *= 2.0;
  for (const Eigen::Isometry3d& bad : {nowhere, scaled})
    EXPECT_THROW(eraseSeenThrough(cloud, camera(), bad, voxel_size, 0.3),
                 BadInputException);
}

} // namespace
