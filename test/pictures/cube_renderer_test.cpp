// SPDX-License-Identifier: BSD-3-Clause
#include "pictures/cube_renderer.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/map/voxel_set.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

namespace pcl_semantic {

namespace {

using Voxels = std::vector<VoxelIndex>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

StereoCamera
cameraOf(double focal_length, int width, int height)
{
  StereoCamera camera;
  camera.fx = camera.fy = focal_length;
  camera.cx = width / 2;
  camera.cy = height / 2;
  camera.baseline = 1.0;
  camera.width = width;
  camera.height = height;
  return camera;
}

/** \brief A box of voxels, each there with a chance; far from the origin if wanted. */
Voxels
randomBox(unsigned seed, int side, double chance, const VoxelIndex& corner)
{
  std::mt19937 random(seed);
  std::bernoulli_distribution is_there(chance);
  Voxels voxels;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x)
        if (is_there(random))
          voxels.push_back(corner + VoxelIndex(x, y, z));
  std::shuffle(voxels.begin(), voxels.end(), random);
  return voxels;
}

/** \brief Part of a ray within a half-open box, from the definition. */
std::pair<double, double>
insideOf(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper,
         const Eigen::Vector3d& ray)
{
  double enter = 0.0, leave = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray[axis] == 0.0) {
      if (!(lower[axis] <= 0.0 && upper[axis] > 0.0))
        return {0.0, 0.0};
      continue;
    }
    const double a = lower[axis] / ray[axis], b = upper[axis] / ray[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return {enter, leave};
}

/** \brief The first voxel of every pixel, by trying all voxels. */
cv::Mat
bruteForce(const Voxels& voxels, double size, const StereoCamera& camera,
           const Eigen::Isometry3d& pose, double max_depth)
{
  std::vector<Eigen::Vector3d> lower, upper;
  for (const VoxelIndex& voxel : voxels) {
    lower.push_back(voxel.cast<double>() * size - pose.translation());
    upper.push_back((voxel + VoxelIndex::Ones()).cast<double>() * size -
                    pose.translation());
  }
  cv::Mat first(camera.height, camera.width, CV_32SC1, cv::Scalar(-1));
  std::vector<bool> too_near(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i)
    for (int corner = 0; corner < 8; ++corner) {
      const VoxelIndex offset(corner & 1, corner >> 1 & 1, corner >> 2);
      const Eigen::Vector3d position =
          (voxels[i] + offset).cast<double>() * size - pose.translation();
      too_near[i] = too_near[i] || pose.linear().col(2).dot(position) < 0.1;
    }
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = pose.linear() * camera.unproject(u, v, 1.0);
      double nearest = kInfinity;
      for (std::size_t i = 0; i < voxels.size(); ++i) {
        const auto [enter, leave] = insideOf(lower[i], upper[i], ray);
        if (too_near[i] || !(enter < leave) || enter > max_depth || enter >= nearest)
          continue;
        nearest = enter;
        first.at<int>(v, u) = static_cast<int>(i);
      }
    }
  return first;
}

Eigen::Isometry3d
randomPose(std::mt19937& random, const Eigen::Vector3d& around, double distance)
{
  std::normal_distribution<double> normal;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d away(normal(random), normal(random), normal(random));
  const Eigen::Vector3d forward = -away.normalized();
  const Eigen::Vector3d right =
      forward.cross(Eigen::Vector3d(normal(random), normal(random), normal(random)))
          .normalized();
  pose.linear() << right, forward.cross(right), forward;
  pose.translation() = around - distance * forward;
  return pose;
}

int
covered(const cv::Mat& voxel)
{
  return cv::countNonZero(voxel >= 0);
}

} // namespace

TEST(CubeRenderer, SeesTheFirstCubeOfEveryRay)
{
  std::mt19937 random(1);
  const StereoCamera camera = cameraOf(40.0, 48, 40);
  for (const double chance : {0.02, 0.3, 0.9})
    for (int trial = 0; trial < 6; ++trial) {
      const VoxelIndex corner(trial % 2 ? 1000000 : -5, trial % 3 - 70000, 3);
      const Voxels voxels = randomBox(unsigned(trial), 9, chance, corner);
      const double size = 0.1 + 0.05 * trial;
      const Eigen::Vector3d centre =
          (corner.cast<double>().array() + 4.5).matrix() * size;
      // From outside, from near, and from within.
      const double distance = (trial % 3 == 0   ? 14.0
                               : trial % 3 == 1 ? 7.0
                                                : 1.0) *
                              size;
      const Eigen::Isometry3d pose = randomPose(random, centre, distance);
      const double max_depth = trial < 3 ? kInfinity : distance + 2.0 * size;
      const CubeImage image = renderCubes(voxels, size, camera, pose, max_depth);
      const cv::Mat expected = bruteForce(voxels, size, camera, pose, max_depth);
      EXPECT_EQ(cv::countNonZero(image.voxel != expected), 0)
          << "chance " << chance << ", trial " << trial;
      if (trial % 3 == 0) {
        EXPECT_GT(covered(expected), 100 * chance);
      }
    }
}

// Rays along edges, faces and diagonals of the lattice, in numbers without rounding.
TEST(CubeRenderer, SeesItAlongTheLatticeToo)
{
  const double size = 0.25;
  const StereoCamera camera = cameraOf(16.0, 65, 49);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (const double chance : {0.1, 0.6, 0.95})
    for (int trial = 0; trial < 4; ++trial) {
      const Voxels voxels = randomBox(unsigned(10 + trial), 12, chance, {4, -6, -6});
      pose.translation() << 0.0, 0.25 * trial, -0.5 * (trial % 2);
      EXPECT_EQ(
          cv::countNonZero(renderCubes(voxels, size, camera, pose, kInfinity).voxel !=
                           bruteForce(voxels, size, camera, pose, kInfinity)),
          0)
          << "chance " << chance << ", trial " << trial;
    }
}

TEST(CubeRenderer, ThreadsAndOrderChangeNothing)
{
  std::mt19937 random(3);
  Voxels voxels = randomBox(4, 16, 0.4, {-8, -8, -8});
  const StereoCamera camera = cameraOf(120.0, 160, 120);
  const Eigen::Isometry3d pose = randomPose(random, Eigen::Vector3d::Zero(), 3.0);
  setNumberOfThreads(1);
  const CubeImage one = renderCubes(voxels, 0.1, camera, pose, kInfinity);
  setNumberOfThreads(5);
  const CubeImage five = renderCubes(voxels, 0.1, camera, pose, kInfinity);
  setNumberOfThreads(0);
  EXPECT_EQ(cv::countNonZero(one.voxel != five.voxel), 0);
  EXPECT_EQ(cv::countNonZero(one.depth != five.depth), 0);
  EXPECT_GT(covered(one.voxel), 1000);
  const Voxels before = voxels;
  std::reverse(voxels.begin(), voxels.end());
  const CubeImage reversed = renderCubes(voxels, 0.1, camera, pose, kInfinity);
  EXPECT_EQ(cv::countNonZero(one.depth != reversed.depth), 0);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const int a = one.voxel.at<int>(v, u), b = reversed.voxel.at<int>(v, u);
      ASSERT_EQ(a < 0, b < 0);
      if (a >= 0) {
        ASSERT_EQ(before[std::size_t(a)], voxels[std::size_t(b)]);
      }
    }
}

TEST(CubeRenderer, RefusesWhatCannotBe)
{
  const Voxels voxels = {{10, 0, 0}};
  const StereoCamera camera = cameraOf(20.0, 16, 16);
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  EXPECT_THROW(renderCubes(voxels, 0.0, camera, pose, 1.0), InvalidParameterException);
  EXPECT_THROW(renderCubes(voxels, 0.1, camera, pose, 0.0), InvalidParameterException);
  EXPECT_THROW(renderCubes(voxels, 0.1, StereoCamera(), pose, 1.0),
               InvalidParameterException);
  EXPECT_EQ(covered(renderCubes({}, 0.1, camera, pose, 1.0).voxel), 0);
}

TEST(VoxelSet, KnowsWhatIsInItAndNothingElse)
{
  const Voxels voxels = randomBox(6, 11, 0.4, {-6, 123450, -1000003});
  const std::set<VoxelIndex, VoxelIndexLess> plain(voxels.begin(), voxels.end());
  Voxels twice = voxels;
  twice.insert(twice.end(), voxels.begin(), voxels.begin() + 50);
  const VoxelSet set(twice);
  EXPECT_EQ(set.size(), voxels.size());
  VoxelSet::Reader reader(set);
  for (int z = -2; z < 14; ++z)
    for (int y = -2; y < 14; ++y)
      for (int x = -2; x < 14; ++x) {
        const VoxelIndex voxel = VoxelIndex(-6, 123450, -1000003) + VoxelIndex(x, y, z);
        ASSERT_EQ(reader.contains(voxel), plain.count(voxel) > 0) << voxel.transpose();
      }
  const VoxelSet empty{Voxels()};
  EXPECT_FALSE(VoxelSet::Reader(empty).contains(VoxelIndex(0, 0, 0)));
}

} // namespace pcl_semantic
