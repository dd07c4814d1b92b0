// SPDX-License-Identifier: BSD-3-Clause
#include "map/ray_caster.h"
#include "support/random_scan.h"
#include "support/supported_tiers.h"

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace pcl_semantic;

constexpr double voxel_size = 0.05;

RayCaster::Settings
settingsTo(double range)
{
  return {voxel_size, range, std::vector<bool>(256, false)};
}

Scan
scanOf(const std::vector<Eigen::Vector3f>& points)
{
  Scan scan;
  scan.points = points;
  return scan;
}

RayCaster::Grid
gridAround(const Eigen::Vector3d& sensor, const Eigen::Vector3i& blocks)
{
  RayCaster::Grid grid(blocks);
  const Eigen::Vector3d centre = sensor / (voxel_size * kBlockEdge);
  grid.scrollTo((centre - 0.5 * blocks.cast<double>()).array().round().cast<int>(),
                [](const VoxelIndex&, VoxelBlock&) {},
                [](const VoxelIndex&) { return std::unique_ptr<VoxelBlock>(); });
  return grid;
}

// The same by the exact traversal of each ray, one after the other.
CrossedVoxels
plainlyCrossed(const std::vector<Eigen::Vector3f>& points,
               const Eigen::Isometry3d& pose, double range, const RayCaster::Grid& grid)
{
  CrossedVoxels crossed(grid.slots());
  crossed.begin(grid);
  for (const Eigen::Vector3f& point : points) {
    const float reach = point.cwiseAbs().maxCoeff();
    const double share = reach <= float(range) ? 1.0 : double(float(range) / reach);
    traverseSegment(quantize(pose.translation(), voxel_size),
                    quantize(pose * (share * point.cast<double>()), voxel_size),
                    [&](const VoxelIndex& voxel) { return crossed.add(voxel); });
  }
  return crossed;
}

void
expectAsPlain(const std::vector<Eigen::Vector3f>& points, const Eigen::Isometry3d& pose,
              double range, const Eigen::Vector3i& blocks)
{
  const RayCaster::Grid grid = gridAround(pose.translation(), blocks);
  const CrossedVoxels expected = plainlyCrossed(points, pose, range, grid);
  std::size_t voxels = 0;
  for (const SimdTier tier : supportedTiers()) {
    RayCaster caster(grid.slots(), tier);
    caster.cast(scanOf(points), pose, grid, settingsTo(range));
    std::size_t missing = 0, more = 0;
    for (std::size_t slot = 0; slot < grid.slots(); ++slot)
      for (std::size_t z = 0; z < CrossedVoxels::kWords; ++z) {
        const std::uint64_t ours = caster.crossed().layers(slot)[z];
        const std::uint64_t plain = expected.layers(slot)[z];
        voxels += std::size_t(__builtin_popcountll(plain));
        missing += std::size_t(__builtin_popcountll(plain & ~ours));
        more += std::size_t(__builtin_popcountll(ours & ~plain));
      }
    EXPECT_EQ(missing, 0u) << nameOf(tier);
    EXPECT_EQ(more, 0u) << nameOf(tier);
    EXPECT_EQ(caster.crossed().blocks(), expected.blocks());
  }
  EXPECT_GT(voxels, 1000u);
}

Eigen::Isometry3d
randomPose(unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Isometry3d pose(
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
          .normalized());
  pose.translation() =
      Eigen::Vector3d(normal(random), normal(random), normal(random)) * 100.0;
  return pose;
}

// Dense enough for bundles of every width, far enough for single rays.
TEST(RayCaster, EqualsTheTraversalOfEachRayInAnyDirection)
{
  for (unsigned seed = 0; seed < 4; ++seed)
    expectAsPlain(makeDenseScan(0.006, 16.0, seed), randomPose(seed), 15.0,
                  {80, 80, 80});
  for (unsigned seed = 20; seed < 26; ++seed) // rays leave the window
    expectAsPlain(makeDenseScan(0.01, 16.0, seed), randomPose(seed), 15.0, {9, 13, 5});
  Eigen::Isometry3d far = randomPose(4);
  far.translation() = Eigen::Vector3d(1e6 + 0.013, -1e6, 2e4);
  expectAsPlain(makeDenseScan(0.01, 12.0, 4), far, 10.0, {60, 60, 60});
}

TEST(RayCaster, EqualsTheTraversalAlongEveryAxis)
{
  // The start at a corner of voxels and rays in the planes between them: nothing is
  // certain there in single precision.
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
      const Eigen::Vector3d forward = sign * Eigen::Vector3d::Unit(axis);
      pose.linear() =
          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), forward)
              .toRotationMatrix();
      expectAsPlain(makeDenseScan(0.0078125, 12.0, 3), pose, 10.0, {60, 60, 60});
    }
}

TEST(RayCaster, EqualsTheTraversalOfSparseAndShortRays)
{
  std::mt19937 random(9);
  for (const float reach : {0.001f, 0.04f, 0.3f, 9.0f}) {
    std::uniform_real_distribution<float> coordinate(-reach, reach);
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 3000; ++i)
      points.emplace_back(coordinate(random), coordinate(random), coordinate(random));
    points.emplace_back(0.0f, 0.0f, 0.0f);
    const RayCaster::Grid grid = gridAround({0, 0, 0}, {50, 50, 50});
    RayCaster caster(grid.slots());
    const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    caster.cast(scanOf(points), pose, grid, settingsTo(8.0));
    const CrossedVoxels expected = plainlyCrossed(points, pose, 8.0, grid);
    for (std::size_t slot = 0; slot < grid.slots(); ++slot)
      for (std::size_t z = 0; z < CrossedVoxels::kWords; ++z)
        ASSERT_EQ(caster.crossed().layers(slot)[z], expected.layers(slot)[z]);
  }
}

// For more than a thousand voxels, products of the exact traversal need 128 bits.
TEST(RayCaster, EqualsTheTraversalOfVeryLongRays)
{
  std::vector<Eigen::Vector3f> points = makeDenseScan(0.02, 150.0, 7);
  for (Eigen::Vector3f& point : points)
    point.head<2>() *= 0.03f;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0.013, 0.021, 70.0);
  expectAsPlain(points, pose, 140.0, {12, 12, 360});
}

TEST(RayCaster, HitsAreThePointsOfTheirBlocks)
{
  const std::vector<Eigen::Vector3f> points = makeDenseScan(0.02, 12.0, 5);
  const Eigen::Isometry3d pose = randomPose(5);
  const RayCaster::Grid grid = gridAround(pose.translation(), {30, 30, 30});
  RayCaster caster(grid.slots());
  for (int repeat = 0; repeat < 2; ++repeat)
    caster.cast(scanOf(points), pose, grid, settingsTo(10.0));
  std::size_t found = 0;
  for (std::size_t slot = 0; slot < grid.slots(); ++slot) {
    const auto [first, last] = caster.hitsIn(slot);
    for (const RayHit* hit = first; hit != last; ++hit, ++found) {
      const VoxelIndex voxel =
          voxelOf(quantize(pose * points[hit->point].cast<double>(), voxel_size));
      EXPECT_EQ(grid.slotOf(blockOf(voxel)), slot);
      EXPECT_EQ(std::uint32_t(voxelInBlock(voxel)), hit->offset);
    }
  }
  std::size_t expected = 0;
  for (const Eigen::Vector3f& point : points)
    expected += point.cwiseAbs().maxCoeff() <= 10.0f &&
                grid.contains(blockOf(
                    voxelOf(quantize(pose * point.cast<double>(), voxel_size))));
  EXPECT_EQ(found, expected);
  EXPECT_GT(found, 100u);
}

} // namespace
