// SPDX-License-Identifier: BSD-3-Clause

// Voxels of dynamic classes become free where scans see past them.

#include "support/named_classes.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <gtest/gtest.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr Label kStill = 1, kMoving = 2;
constexpr double kVoxel = 0.25;

LabelSet
twoClasses()
{
  std::vector<LabelClass> classes = namedClasses({"still", "moving"});
  classes[1].dynamic = true;
  return LabelSet(classes);
}

SemanticVoxelMap::Parameters
smallWindow()
{
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = kVoxel;
  parameters.window = {32, 32, 8};
  parameters.max_range = 20;
  return parameters;
}

struct LabelledScan {
  pcl::PointCloud<pcl::PointXYZ> cloud;
  std::vector<Label> labels;

  void
  add(const pcl::PointXYZ& point, Label label)
  {
    cloud.push_back(point);
    labels.push_back(label);
  }

  LabelDistributions
  distributions() const
  {
    LabelDistributions result(2, Eigen::Index(labels.size()));
    for (std::size_t i = 0; i < labels.size(); ++i)
      result.setLabel(Eigen::Index(i), labels[i], 0.9f);
    return result;
  }
};

// A dense square across the x axis, 2 m wide and high.
LabelledScan
square(double x, Label label)
{
  LabelledScan scan;
  for (int u = -25; u <= 25; ++u)
    for (int v = -25; v <= 25; ++v)
      scan.add({float(x), float(0.04 * u), float(0.04 * v)}, label);
  return scan;
}

class SeenPast : public testing::Test {
protected:
  void
  integrate(const LabelledScan& scan,
            const Eigen::Isometry3d& pose = Eigen::Isometry3d::Identity())
  {
    counts_ = map_.integrate(scan.cloud, pose, scan.distributions());
  }

  // Occupied voxels with the label of the moving class.
  std::size_t
  moving() const
  {
    std::size_t count = 0;
    const VoxelCloud occupied = map_.occupied();
    for (const pcl::PointXYZRGBL& point : *occupied.cloud)
      count += point.label == kMoving;
    return count;
  }

  SemanticVoxelMap map_{twoClasses(), smallWindow()};
  ScanCounts counts_;
};

TEST_F(SeenPast, OneScanFreesAVoxel)
{
  for (int i = 0; i < 9; ++i) // as sure as it can be
    integrate(square(5.1, kMoving));
  const std::size_t seen = moving();
  ASSERT_GT(seen, 20u);
  integrate(square(9.1, kStill));
  // Rays to a square of the same size pass the inner voxels.
  EXPECT_GT(counts_.freed, seen / 5);
  EXPECT_EQ(moving(), seen - counts_.freed);
  EXPECT_EQ(map_.state({5.1, 0.0, 0.0}).occupancy, Occupancy::free);
  EXPECT_EQ(map_.state({5.1, 0.0, 0.0}).observations, 0u) << "it has lost its past";
  integrate(square(5.1, kStill)); // one hit makes it occupied again
  EXPECT_EQ(map_.state({5.1, 0.0, 0.0}).label, kStill);
}

TEST_F(SeenPast, DepthsWithErrorsFreeLess)
{
  const auto freed = [&](double error, double wall) {
    for (int i = 0; i < 9; ++i)
      integrate(square(5.1, kMoving));
    map_.setDepthError(error);
    integrate(square(wall, kStill));
    map_.setDepthError(0.0);
    return counts_.freed;
  };
  EXPECT_GT(freed(0.0120, 19.9), 0u);
  EXPECT_EQ(freed(0.0126, 19.9), 0u) << "three deviations of the wall are 15 m";
  EXPECT_GT(freed(0.0120, 12.1), 0u);
  EXPECT_EQ(freed(0.0135, 12.1), 0u) << "three deviations of the voxel are 1.06 m";
  EXPECT_THROW(map_.setDepthError(-1.0), InvalidParameterException);
  EXPECT_THROW(map_.setDepthError(std::nan("")), InvalidParameterException);
}

TEST_F(SeenPast, EverythingElseStays)
{
  const auto expectStays = [&](const char* what, const LabelledScan& before,
                               const LabelledScan& scan,
                               const Eigen::Isometry3d& pose) {
    SemanticVoxelMap map(twoClasses(), smallWindow());
    for (int i = 0; i < 9; ++i)
      map.integrate(before.cloud, Eigen::Isometry3d::Identity(),
                    before.distributions());
    EXPECT_EQ(map.integrate(scan.cloud, pose, scan.distributions()).freed, 0u) << what;
  };
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d turned = here;
  turned.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  expectStays("a still class", square(5.1, kStill), square(9.1, kStill), here);
  expectStays("out of view", square(5.1, kMoving), square(9.1, kStill), turned);
  expectStays("hidden", square(5.1, kMoving), square(3.1, kStill), here);
  expectStays("too near behind", square(5.1, kMoving), square(5.9, kStill), here);
  expectStays("rays end on its class", square(5.1, kMoving), square(9.1, kMoving),
              here);
  for (const Label label : {kMoving, kUnlabelled}) {
    LabelledScan beside = square(9.1, kStill); // a hit in the voxel next to each
    for (const pcl::PointXYZ& point : square(5.4, kStill).cloud)
      beside.add(point, label);
    expectStays("a neighbour is hit", square(5.1, kMoving), beside, here);
  }
  LabelledScan one; // in the middle of a voxel
  one.add({9.1f, 0.2f, 0.2f}, kStill);
  expectStays("one ray", square(5.1, kMoving), one, here);
  SemanticVoxelMap::Parameters off = smallWindow();
  off.fusion.free_dynamic = false;
  SemanticVoxelMap map(twoClasses(), off);
  const LabelledScan car = square(5.1, kMoving), wall = square(9.1, kStill);
  map.integrate(car.cloud, here, car.distributions());
  EXPECT_EQ(map.integrate(wall.cloud, here, wall.distributions()).freed, 0u);
}

// With objects: a hit of a dynamic class makes a voxel occupied that was often seen
// free.
TEST(OccupyDynamic, OneHitOfADynamicClassIsEnough)
{
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d place(5.1, 0.1, 0.1);
  for (const bool occupy : {false, true})
    for (const Label label : {kStill, kMoving}) {
      SemanticVoxelMap::Parameters parameters = smallWindow();
      parameters.fusion.occupy_dynamic = occupy;
      SemanticVoxelMap map(twoClasses(), parameters);
      const LabelledScan wall = square(9.1, kStill), near = square(5.1, label);
      for (int i = 0; i < 9; ++i)
        map.integrate(wall.cloud, here, wall.distributions());
      ASSERT_EQ(map.state(place).occupancy, Occupancy::free);
      map.integrate(near.cloud, here, near.distributions());
      EXPECT_EQ(map.state(place).occupancy == Occupancy::occupied,
                occupy && label == kMoving);
      map.integrate(wall.cloud, here, wall.distributions());
      EXPECT_EQ(map.state(place).occupancy, Occupancy::free) << "one miss is enough";
    }
}

using Index = std::tuple<int, int, int>;

Index
indexOf(const VoxelIndex& voxel)
{
  return {voxel.x(), voxel.y(), voxel.z()};
}

// The rule, voxel by voxel and ray by ray.
std::size_t
plainCount(const VoxelCloud& voxels, const LabelledScan& scan,
           const Eigen::Isometry3d& T_world_sensor)
{
  std::set<Index> hits, moving_hits;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    const Eigen::Vector3f point = scan.cloud[i].getVector3fMap();
    const Eigen::Vector3d end = T_world_sensor * point.cast<double>();
    if (point.cwiseAbs().maxCoeff() > 20.0f)
      continue;
    const Index voxel = indexOf((end / kVoxel).array().floor().cast<int>().matrix());
    hits.insert(voxel);
    if (scan.labels[i] == kMoving)
      moving_hits.insert(voxel);
  }
  const auto isHeld = [&](const VoxelIndex& voxel) {
    if (hits.count(indexOf(voxel)) > 0)
      return true;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (moving_hits.count(indexOf(voxel + VoxelIndex(x, y, z))) > 0)
            return true;
    return false;
  };
  const Eigen::Vector3d start = T_world_sensor.translation();
  std::size_t freed = 0;
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    const VoxelIndex& voxel = voxels.indices[v];
    if ((*voxels.cloud)[v].label != kMoving || isHeld(voxel))
      continue;
    int rays = 0;
    for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
      const Eigen::Vector3d end =
          T_world_sensor * scan.cloud[i].getVector3fMap().cast<double>();
      const Eigen::AlignedBox3d box(voxel.cast<double>() * kVoxel,
                                    (voxel + VoxelIndex::Ones()).cast<double>() *
                                        kVoxel);
      // Sampled: 400 steps a voxel.
      const double length = (end - start).norm();
      const double step = kVoxel / 400.0;
      const double middle = (box.center() - start).dot(end - start) / length;
      if ((start + (end - start) * (middle / length) - box.center()).norm() > kVoxel)
        continue;
      double exit = -1.0;
      for (double at = middle - kVoxel; at <= middle + kVoxel; at += step)
        if (at > 0.0 && box.contains((start + (end - start) * (at / length)).eval()))
          exit = at;
      rays += exit > 0.0 && exit <= length - 1.0 && scan.labels[i] != kMoving;
    }
    freed += rays >= 2;
  }
  return freed;
}

TEST_F(SeenPast, AgreesWithThePlainRule)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::size_t all = 0, difference = 0;
  for (int trial = 0; trial < 6; ++trial) {
    SemanticVoxelMap map(twoClasses(), smallWindow());
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.rotate(Eigen::AngleAxisd(3.0 * uniform(random), Eigen::Vector3d::UnitZ()));
    pose.translation() = Eigen::Vector3d(uniform(random), uniform(random), 0.1);
    LabelledScan near, far;
    for (int i = 0; i < 120; ++i) {
      const Eigen::Vector3d direction =
          Eigen::Vector3d(uniform(random), uniform(random), 0.3 * uniform(random))
              .normalized();
      const Eigen::Vector3f point =
          (direction * (3.0 + 2.0 * uniform(random))).cast<float>();
      near.add({point.x(), point.y(), point.z()}, i % 3 == 0 ? kStill : kMoving);
      for (int ray = 0; ray < 12; ++ray) {
        const Eigen::Vector3f end =
            (direction * (7.0 + 3.0 * uniform(random)) +
             0.2 * Eigen::Vector3d(uniform(random), uniform(random), uniform(random)))
                .cast<float>();
        far.add({end.x(), end.y(), end.z()}, ray % 5 == 0 ? kMoving : kStill);
      }
      if (i % 4 == 0) { // ends in or beside the voxel
        const Eigen::Vector3f end = point + 0.3f * Eigen::Vector3f::Unit(i / 4 % 3);
        far.add({end.x(), end.y(), end.z()}, i % 8 == 0 ? kMoving : kStill);
      }
    }
    map.integrate(near.cloud, pose, near.distributions());
    map.integrate(near.cloud, pose, near.distributions());
    // Misses of the second scan free none: two hits outlast one miss.
    const std::size_t expected = plainCount(map.occupied(), far, pose);
    const std::size_t freed = map.integrate(far.cloud, pose, far.distributions()).freed;
    all += expected;
    difference += freed > expected ? freed - expected : expected - freed;
  }
  EXPECT_GT(all, 100u);
  EXPECT_LE(difference, all / 50) << "of " << all << ": corners cut by under a step";
}

TEST_F(SeenPast, TheOrderOfPointsAndThreadsChangeNothing)
{
  std::vector<std::vector<float>> log_odds;
  for (const int threads : {1, 3}) {
    SemanticVoxelMap map(twoClasses(), smallWindow());
    map.setNumberOfThreads(threads);
    map.setDepthError(0.0005);
    for (int i = 0; i < 6; ++i) {
      LabelledScan scan = i < 2 ? square(5.1, kMoving) : square(9.1, kStill);
      if (threads == 3) {
        std::reverse(scan.cloud.begin(), scan.cloud.end());
        std::reverse(scan.labels.begin(), scan.labels.end());
      }
      map.integrate(scan.cloud, Eigen::Isometry3d::Identity(), scan.distributions());
    }
    log_odds.emplace_back();
    for (const VoxelState& state : map.states(Eigen::AlignedBox3d(
             Eigen::Vector3d(4, -2, -2), Eigen::Vector3d(10, 2, 2))))
      log_odds.back().push_back(state.log_odds);
  }
  EXPECT_EQ(log_odds[0], log_odds[1]);
}

} // namespace

} // namespace pcl_semantic
