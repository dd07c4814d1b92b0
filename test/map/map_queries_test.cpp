// SPDX-License-Identifier: BSD-3-Clause
#include "map/ray_traversal.h"
#include "support/random_scan.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/map/map_doubts.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

namespace {

using namespace pcl_semantic;

LabelSet
twoClasses()
{
  return LabelSet({{"house", {200, 0, 0}}, {"car", {0, 0, 200}, false, true}});
}

SemanticVoxelMap::Parameters
smallWindow()
{
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = 0.5;
  parameters.window = {24.0, 24.0, 8.0};
  parameters.max_range = 10.0;
  return parameters;
}

// A wall across x at 6.25 m, of one class, and the sensor at the origin.
LabelledScan
wall(Label label)
{
  LabelledScan scan;
  for (double y = -2.0; y <= 2.0; y += 0.1)
    for (double z = -1.0; z <= 1.0; z += 0.1) {
      pcl::PointXYZRGB point;
      point.getVector3fMap() << 6.25f, float(y), float(z);
      point.rgba = 0xFF0A141Eu; // 10, 20, 30
      scan.cloud.push_back(point);
    }
  scan.distributions = LabelDistributions(2, Eigen::Index(scan.cloud.size()));
  for (Eigen::Index i = 0; i < scan.distributions.size(); ++i)
    scan.distributions.setLabel(i, label, 0.8f);
  return scan;
}

const Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();

TEST(MapQueries, AVoxelTellsAllThatIsKnown)
{
  SemanticVoxelMap map(twoClasses(), smallWindow());
  const LabelledScan scan = wall(1);
  map.integrate(scan.cloud, origin, scan.distributions);
  map.integrate(scan.cloud, origin, scan.distributions);
  const VoxelState hit = map.state({6.1, 0.2, 0.3});
  EXPECT_EQ(hit.index, VoxelIndex(12, 0, 0));
  EXPECT_EQ(hit.occupancy, Occupancy::occupied);
  EXPECT_NEAR(hit.log_odds, 2.0 * std::log(0.7 / 0.3), 1e-3);
  EXPECT_EQ(hit.observations, 2u);
  EXPECT_EQ(hit.label, 1);
  EXPECT_EQ(hit.colour, (std::array<std::uint8_t, 3>{10, 20, 30}));
  const double p = 0.8 * 0.8 / (0.8 * 0.8 + 0.2 * 0.2);
  EXPECT_NEAR(hit.measured[0], p, 1e-5);
  EXPECT_EQ(hit.refined, hit.measured);
  EXPECT_NEAR(hit.entropy, -p * std::log(p) - (1 - p) * std::log(1 - p), 1e-4);

  const VoxelState free = map.state({3.1, 0.1, 0.1});
  EXPECT_EQ(free.occupancy, Occupancy::free);
  EXPECT_NEAR(free.log_odds, 2.0 * std::log(0.4 / 0.6), 1e-3);
  EXPECT_EQ(free.label, kUnlabelled);
  EXPECT_NEAR(free.entropy, std::log(2.0), 1e-6);

  for (const Eigen::Vector3d& unknown :
       {Eigen::Vector3d(8, 0, 0), Eigen::Vector3d(500, 0, 0),
        Eigen::Vector3d(std::nan(""), 0, 0)}) {
    EXPECT_EQ(map.state(unknown).occupancy, Occupancy::unknown);
    EXPECT_EQ(map.occupancy(unknown), Occupancy::unknown);
  }
  EXPECT_EQ(map.labels({{6.1, 0.2, 0.3}, {3.1, 0.1, 0.1}}),
            (std::vector<Label>{1, kUnlabelled}));
}

TEST(MapQueries, ABoxGivesItsKnownVoxels)
{
  SemanticVoxelMap map(twoClasses(), smallWindow());
  const LabelledScan scan = makeRandomScan(400, 8.0f, 2, 3);
  map.integrate(scan.cloud, origin, scan.distributions);
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-3.2, -2.0, -1.0),
                                Eigen::Vector3d(2.4, 3.3, 1.2));
  std::size_t expected = 0;
  for (int z = -2; z <= 2; ++z)
    for (int y = -4; y <= 6; ++y)
      for (int x = -7; x <= 4; ++x)
        expected += map.occupancy(Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) * 0.5) !=
                    Occupancy::unknown;
  const std::vector<VoxelState> states = map.states(box);
  EXPECT_EQ(states.size(), expected);
  EXPECT_GT(states.size(), 100u);
  for (const VoxelState& state : states) {
    const VoxelState again =
        map.state((state.index.cast<double>().array() + 0.5).matrix() * 0.5);
    EXPECT_EQ(again.index, state.index);
    EXPECT_EQ(again.log_odds, state.log_odds);
    EXPECT_EQ(again.measured, state.measured);
  }
  EXPECT_TRUE(map.states(Eigen::AlignedBox3d()).empty());
  const Eigen::Vector3d hit = scan.cloud[0].getVector3fMap().cast<double>();
  const std::vector<VoxelState> at_point = map.states(Eigen::AlignedBox3d(hit, hit));
  ASSERT_EQ(at_point.size(), 1u);
  EXPECT_EQ(at_point[0].index, map.voxelOf(hit));
}

TEST(MapQueries, ARayFindsTheFirstOccupiedVoxel)
{
  SemanticVoxelMap map(twoClasses(), smallWindow());
  const LabelledScan scan = wall(2);
  map.integrate(scan.cloud, origin, scan.distributions);
  const auto hit = map.firstOccupied({0, 0, 0}, {9, 1, 0.5});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->index, VoxelIndex(12, 1, 0));
  EXPECT_EQ(hit->label, 2);
  EXPECT_FALSE(map.firstOccupied({0, 0, 0}, {5.9, 0, 0}));
  EXPECT_FALSE(map.firstOccupied({0, 0, 0}, {-9, 0, 0}));
  EXPECT_FALSE(map.firstOccupied({0, 0, 0}, {INFINITY, 0, 0}));
}

// Rays from far outside, through the window and past it, against the exact traversal of
// the whole segment.
TEST(MapQueries, ARayFromAnywhereFindsWhatItsTraversalFinds)
{
  SemanticVoxelMap map(twoClasses(), smallWindow());
  map.integrate(makeRandomScan(400, 8.0f, 2, 3).cloud, origin);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> inside(-14.0, 14.0), far(-900.0, 900.0);
  int found = 0, from_outside = 0;
  for (int i = 0; i < 800; ++i) {
    const Eigen::Vector3d target(inside(random), inside(random), 0.5 * inside(random));
    Eigen::Vector3d from(far(random), far(random), far(random));
    if (i % 4 == 0)
      from = 0.01 * from;
    const Eigen::Vector3d to = from + (i % 3 == 0 ? 1.0 : 1.9) * (target - from);
    std::optional<VoxelIndex> expected;
    traverseSegment(quantize(from, 0.5), quantize(to, 0.5), [&](const VoxelIndex& v) {
      if (map.occupancy((v.cast<double>().array() + 0.5) * 0.5) == Occupancy::occupied)
        expected = v;
      return !expected;
    });
    const auto hit = map.firstOccupied(from, to);
    ASSERT_EQ(bool(hit), bool(expected))
        << from.transpose() << " to " << to.transpose();
    if (hit) {
      EXPECT_EQ(hit->index, *expected);
    }
    found += bool(hit);
    from_outside += hit && from.norm() > 30.0;
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(from_outside, 50);
  // A window that has not been anywhere.
  EXPECT_FALSE(SemanticVoxelMap(twoClasses(), smallWindow())
                   .firstOccupied({-4e8, -4e8, -4e8}, {4e8, 4e8, 4e8}));
  // Ends at once, though the segment has two billion voxels.
  EXPECT_FALSE(map.firstOccupied({-4e8, 3.0, 4.0}, {4e8, 3.0, 4.0}));
  EXPECT_FALSE(map.firstOccupied({4e8, 4e8, 4e8}, {-4e8, 4e8, 4e8}));
}

// At 0.1 m floor(x / 0.1) and the grid that scans are quantised to disagree about x.
TEST(MapQueries, APointIsAskedForWhereItWasHit)
{
  SemanticVoxelMap::Parameters parameters = smallWindow();
  parameters.voxel_size = 0.1;
  for (const float x : {0.3f, 0.6f, 0.7f, 1.2f, -0.3f}) {
    SemanticVoxelMap map(twoClasses(), parameters);
    pcl::PointCloud<pcl::PointXYZ> cloud;
    cloud.push_back({x, 0.0f, 0.0f});
    map.integrate(cloud, origin);
    EXPECT_EQ(map.occupancy({double(x), 0.0, 0.0}), Occupancy::occupied) << x;
    EXPECT_EQ(map.voxelOf({double(x), 0.0, 0.0}), map.occupied().indices[0]) << x;
  }
  SemanticVoxelMap map(twoClasses(), parameters);
  EXPECT_EQ(map.voxelOf({0.3, 0.7, 1.1}), voxelOf(quantize({0.3, 0.7, 1.1}, 0.1)));
  for (const double x : {std::nan(""), double(INFINITY), 1e30})
    EXPECT_THROW(map.voxelOf({x, 0, 0}), InvalidParameterException);
}

TEST(MapQueries, TheWindowMovesWithoutAScan)
{
  SemanticVoxelMap map(twoClasses(), smallWindow());
  const LabelledScan scan = wall(1);
  map.integrate(scan.cloud, origin, scan.distributions);
  map.moveWindow({100.0, 0.0, 0.0});
  EXPECT_EQ(map.occupancy({6.1, 0.2, 0.3}), Occupancy::unknown);
  map.moveWindow({10.0, 5.0, 0.0});
  EXPECT_EQ(map.occupancy({6.1, 0.2, 0.3}), Occupancy::occupied);
  EXPECT_THROW(map.moveWindow({std::nan(""), 0, 0}), BadInputException);
  EXPECT_THROW(map.setCloudOrigin({std::nan(""), 0, 0}), InvalidParameterException);
}

TEST(MapQueries, NothingIsClearedWithinTwoDeviations)
{
  SemanticVoxelMap map(twoClasses(), smallWindow());
  pcl::PointCloud<pcl::PointXYZ> cloud;
  cloud.push_back({6.25f, 0.2f, 0.2f});
  map.integrate(cloud, origin, {}, {1.0f});
  for (double x = 0.25; x < 6.0; x += 0.5)
    EXPECT_EQ(map.occupancy({x, 0.2 * x / 6.25, 0.2 * x / 6.25}),
              x < 4.5 ? Occupancy::free : Occupancy::unknown)
        << x;
  // It weighs as much as the probability that it lies within half a voxel.
  EXPECT_NEAR(map.state({6.25, 0.2, 0.2}).log_odds,
              std::erf(0.25 / std::sqrt(2.0)) * std::log(0.7 / 0.3), 1e-3);
  EXPECT_EQ(map.integrate(cloud, origin, {}, {std::nanf("")}).invalid, 1u);
  EXPECT_EQ(map.integrate(cloud, origin, {}, {100.0f}).rays, 1u); // clears nothing
  EXPECT_THROW(map.integrate(cloud, origin, {}, {1.0f, 2.0f}),
               InvalidParameterException);
}

TEST(MapQueries, EveryRayCountsIfAskedTo)
{
  SemanticVoxelMap::Parameters parameters = smallWindow();
  parameters.fusion.per_ray_counting = true;
  parameters.fusion.clearing = Clearing::full;
  SemanticVoxelMap map(twoClasses(), parameters);
  pcl::PointCloud<pcl::PointXYZ> cloud;
  for (int i = 0; i < 3; ++i)
    cloud.push_back({6.25f, 0.2f, 0.2f});
  cloud.push_back({8.25f, 0.25f, 0.25f}); // through the voxel of the others
  map.integrate(cloud, origin);
  EXPECT_NEAR(map.state({6.25, 0.2, 0.2}).log_odds,
              3.0 * std::log(0.7 / 0.3) + std::log(0.4 / 0.6), 1e-3);
  EXPECT_NEAR(map.state({2.25, 0.1, 0.1}).log_odds, 4.0 * std::log(0.4 / 0.6), 1e-3);
  EXPECT_EQ(map.state({6.25, 0.2, 0.2}).observations, 1u);
  // A hit that is uncertain weighs less here too.
  SemanticVoxelMap uncertain(twoClasses(), parameters);
  cloud.resize(1);
  uncertain.integrate(cloud, origin, {}, {1.0f});
  EXPECT_NEAR(uncertain.state({6.25, 0.2, 0.2}).log_odds,
              std::erf(0.25 / std::sqrt(2.0)) * std::log(0.7 / 0.3), 1e-3);
}

// Each scan turns the wall to the other class and back: a reader that saw a scan half
// done would find both.
TEST(MapQueries, AReaderSeesWholeScans)
{
  SemanticVoxelMap::Parameters parameters = smallWindow();
  parameters.fusion.label_max_ratio = 2.0; // turns at once
  SemanticVoxelMap map(twoClasses(), parameters);
  const LabelledScan scans[2] = {wall(1), wall(2)};
  map.integrate(scans[0].cloud, origin, scans[0].distributions);
  const std::size_t count = map.occupied().size();
  std::atomic<bool> done{false};
  std::atomic<int> reads{0}, torn{0};
  const auto read = [&] {
    while (!done) {
      const VoxelCloud voxels = map.occupied();
      bool whole = voxels.size() == count;
      for (const pcl::PointXYZRGBL& point : *voxels.cloud)
        whole &= point.label == (*voxels.cloud)[0].label;
      torn += !whole;
      const auto hit = map.firstOccupied({0, 0, 0}, {9, 1, 0.5});
      torn += !hit || map.labels({{6.1, 0.2, 0.3}})[0] == kUnlabelled;
      ++reads;
    }
  };
  std::thread readers[2] = {std::thread(read), std::thread(read)};
  for (int i = 0; i < 60 || reads < 20; ++i) {
    const LabelledScan& scan = scans[(i + 1) % 2];
    map.integrate(scan.cloud, origin, scan.distributions);
  }
  done = true;
  for (std::thread& reader : readers)
    reader.join();
  EXPECT_EQ(torn, 0);
}

TEST(MapDoubts, LengthsInOtherUnits)
{
  MapParameters parameters;
  EXPECT_TRUE(doubtsOf(parameters).empty());
  parameters.voxel_size = 20.0;
  parameters.max_range = 4000.0;
  const auto doubts = doubtsOf(parameters);
  ASSERT_EQ(doubts.size(), 2u);
  EXPECT_TRUE(holds(doubts[0], "voxel_size is 20 m"));
  EXPECT_TRUE(holds(doubts[1], "max_depth is 4000 m"));
}

} // namespace
