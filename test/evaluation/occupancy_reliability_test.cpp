// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/occupancy_reliability.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace {

using namespace pcl_semantic;

constexpr double voxel_size = 0.1;
constexpr float hit = 0.85f, missed = -0.4f; // log-odds

// Of voxels along x; the others are unknown.
MemoryBlockStore
row(const std::vector<std::pair<int, float>>& log_odds)
{
  std::map<int, VoxelBlock> blocks;
  for (const auto& [x, value] : log_odds) {
    const VoxelIndex voxel(x, 0, 0);
    blocks[blockOf(voxel).x()].log_odds[std::size_t(voxelInBlock(voxel))] =
        StoredLogOdds(value / kLogOddsUnit);
  }
  MemoryBlockStore store;
  for (const auto& [x, block] : blocks)
    store.put({x, 0, 0}, block);
  return store;
}

Eigen::Vector3d
alongX(double x)
{
  return {x, 0.05, 0.05};
}

struct Counts {
  std::uint64_t occupied, voxels;
};

Counts
countsOf(const Reliability::Curve& curve, float log_odds)
{
  const float p = occupancyProbability(log_odds);
  const Reliability::Bin& bin = curve[std::size_t(p * float(curve.size()))];
  return {bin.right, bin.pixels};
}

std::uint64_t
voxelsOf(const Reliability::Curve& curve)
{
  std::uint64_t voxels = 0;
  for (const Reliability::Bin& bin : curve)
    voxels += bin.pixels;
  return voxels;
}

TEST(OccupancyProbability, BeginsAtThePriorAndKeepsTheOrder)
{
  EXPECT_FLOAT_EQ(occupancyProbability(0.0f), kOccupancyPrior);
  EXPECT_LT(occupancyProbability(missed), kOccupancyPrior);
  EXPECT_NEAR(occupancyProbability(hit), 0.464, 0.001); // 0.27 / 0.73 * e^0.85 to 1
}

TEST(OccupancyReliability, ABeamFreesWhatItPassesAndEndsInWhatIsOccupied)
{
  OccupancyReliability reliability(
      row({{30, missed}, {31, hit}, {49, missed}, {50, hit}, {51, hit}, {70, hit}}),
      voxel_size);
  reliability.addScan({alongX(5.05)}, Eigen::Isometry3d::Identity());
  // 49 is next to the end; 51 and 70 were not reached, and 51 hides nothing.
  EXPECT_EQ(voxelsOf(reliability.curve()), 4u);
  EXPECT_EQ(countsOf(reliability.curve(), missed).voxels, 2u);
  EXPECT_EQ(countsOf(reliability.curve(), missed).occupied, 1u);
  EXPECT_EQ(countsOf(reliability.curve(), hit).voxels, 2u);
  EXPECT_EQ(countsOf(reliability.curve(), hit).occupied, 1u);
}

TEST(OccupancyReliability, AVoxelCountsOnceAScan)
{
  OccupancyReliability reliability(row({{30, missed}}), voxel_size);
  for (int scan = 0; scan < 3; ++scan)
    reliability.addScan({alongX(5.05), alongX(6.05), alongX(7.05)},
                        Eigen::Isometry3d::Identity());
  EXPECT_EQ(voxelsOf(reliability.curve()), 3u);
}

TEST(OccupancyReliability, TakesPosesAndPassesOverWhatIsNoReturn)
{
  OccupancyReliability reliability(row({{30, missed}}), voxel_size);
  const double none = std::numeric_limits<double>::quiet_NaN();
  reliability.addScan({alongX(1.5), {none, 0.0, 0.0}, {1e300, 0.0, 0.0}},
                      Eigen::Isometry3d(Eigen::Translation3d(2.0, 0.0, 0.0)));
  EXPECT_EQ(voxelsOf(reliability.curve()), 0u);
  reliability.addScan({alongX(3.0)},
                      Eigen::Isometry3d(Eigen::Translation3d(2.0, 0.0, 0.0)));
  EXPECT_EQ(voxelsOf(reliability.curve()), 1u);
}

TEST(OccupancyReliability, ItsErrorIsThatOfUndecidedVoxels)
{
  Reliability::Curve curve(Reliability::kBins);
  Reliability::count(0.01f, true, curve); // wrong, but decided
  Reliability::count(0.99f, false, curve);
  EXPECT_TRUE(std::isnan(undecidedError(curve)));
  for (int i = 0; i < 4; ++i)
    Reliability::count(0.5f, i == 0, curve);
  EXPECT_NEAR(undecidedError(curve), 0.25, 1e-6);
}

} // namespace
