// SPDX-License-Identifier: BSD-3-Clause
#include "support/clique_lists.h"
#include "support/street_scans.h"
#include "support/thrown_message.h"

#include <pcl_semantic/cliques/supervoxel_cliques.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>
#include <pcl/common/io.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

using namespace pcl_semantic;

namespace {

using Cloud = CliqueGenerator::Cloud;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Cliques
cliquesOf(SupervoxelCliques& generator, const Cloud& cloud)
{
  return listsOf(generator.generate(cloud));
}

Cliques
cliquesOf(const Cloud& cloud, const SupervoxelParameters& parameters = {})
{
  SupervoxelCliques generator(parameters);
  return cliquesOf(generator, cloud);
}

Cloud
streetMap()
{
  static const VoxelCloud voxels = makeStreetMap(2, 310, 94);
  Cloud cloud;
  pcl::copyPointCloud(*voxels.cloud, cloud);
  return cloud;
}

// The floor and a wall of a room, in other colours, points 0.1 m apart.
Cloud
roomAt(const Eigen::Vector3d& corner)
{
  Cloud cloud;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 30; ++j) {
      pcl::PointXYZRGB floor, wall;
      floor.getVector3fMap() =
          (corner + Eigen::Vector3d(0.1 * i + 0.05, 0.1 * j + 0.05, 0.05))
              .cast<float>();
      wall.getVector3fMap() =
          (corner + Eigen::Vector3d(0.1 * i + 0.05, 3.05, 0.1 * j + 0.15))
              .cast<float>();
      floor.r = floor.g = floor.b = 60;
      wall.r = wall.g = wall.b = 200;
      cloud.push_back(floor);
      cloud.push_back(wall);
    }
  return cloud;
}

// Every point at most once, lists ascending, none empty, in the order of first points.
void
expectSound(const Cliques& cliques, const Cloud& cloud)
{
  std::vector<int> count(cloud.size(), 0);
  int last = -1;
  for (const std::vector<int>& clique : cliques) {
    ASSERT_FALSE(clique.empty());
    EXPECT_TRUE(std::is_sorted(clique.begin(), clique.end()));
    EXPECT_GT(clique.front(), last);
    last = clique.front();
    for (const int i : clique) {
      ASSERT_GE(i, 0);
      ASSERT_LT(i, int(cloud.size()));
      EXPECT_EQ(++count[std::size_t(i)], 1);
      EXPECT_TRUE(std::isfinite(cloud[std::size_t(i)].x));
    }
  }
}

} // namespace

TEST(SupervoxelCliques, CoverAMapWithGroupsOfTheirSize)
{
  const Cloud cloud = streetMap();
  const Cliques cliques = cliquesOf(cloud);
  expectSound(cliques, cloud);
  EXPECT_GT(membersOf(cliques), cloud.size() * 95 / 100);
  EXPECT_GT(cliques.size(), 100u);
  EXPECT_LT(cliques.size(), cloud.size() / 5);
  for (const std::vector<int>& clique : cliques)
    for (const int i :
         clique) { // a supervoxel grows to less than 1.8 seeds from its own
      const Eigen::Vector3f way = cloud[std::size_t(i)].getVector3fMap() -
                                  cloud[std::size_t(clique[0])].getVector3fMap();
      ASSERT_LT(way.lpNorm<Eigen::Infinity>(), 2 * 1.8f * 0.8f + 2 * 0.8f);
    }
}

TEST(SupervoxelCliques, KeepAFloorAndAWallApart)
{
  const Cloud cloud = roomAt({-1.0, 2.0, -0.5});
  const Cliques cliques = cliquesOf(cloud);
  expectSound(cliques, cloud);
  EXPECT_EQ(membersOf(cliques), cloud.size());
  EXPECT_GT(cliques.size(), 20u);
  std::size_t strays = 0; // odd points are the wall's
  for (const std::vector<int>& clique : cliques) {
    const auto walls = std::size_t(
        std::count_if(clique.begin(), clique.end(), [](int i) { return i % 2 == 1; }));
    strays += std::min(walls, clique.size() - walls);
  }
  EXPECT_LT(double(strays), 0.02 * double(cloud.size()));
}

TEST(SupervoxelCliques, NeitherThreadsNorRunsNorOrderChangeAnything)
{
  const Cloud cloud = streetMap();
  setNumberOfThreads(1);
  const Cliques expected = cliquesOf(cloud);
  for (const int threads : {1, 2, 7}) {
    setNumberOfThreads(threads);
    EXPECT_TRUE(cliquesOf(cloud) == expected) << threads;
  }
  setNumberOfThreads(0);

  std::vector<int> order(cloud.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  Cloud shuffled;
  for (const int i : order)
    shuffled.push_back(cloud[std::size_t(i)]);
  std::set<std::set<int>> groups, expected_groups;
  for (const std::vector<int>& clique : cliquesOf(shuffled)) {
    std::set<int> group;
    for (const int i : clique)
      group.insert(order[std::size_t(i)]);
    groups.insert(group);
  }
  for (const std::vector<int>& clique : expected)
    expected_groups.insert({clique.begin(), clique.end()});
  EXPECT_TRUE(groups == expected_groups);
}

TEST(SupervoxelCliques, WhatHasNotChangedIsTakenOver)
{
  Cloud cloud = streetMap();
  SupervoxelCliques generator;
  const Cliques first = cliquesOf(generator, cloud);
  EXPECT_EQ(generator.changedCubes(), generator.cubes());
  EXPECT_GT(generator.cubes(), 8u);
  EXPECT_TRUE(cliquesOf(generator, cloud) == first);
  EXPECT_EQ(generator.changedCubes(), 0u);

  std::mt19937 random(3);
  for (int run = 0; run < 5; ++run) { // colours and points change somewhere
    for (int i = 0; i < 40; ++i)
      cloud[random() % cloud.size()].r = std::uint8_t(random());
    const Eigen::Vector3f place = cloud[random() % cloud.size()].getVector3fMap();
    Cloud changed;
    for (const pcl::PointXYZRGB& point : cloud)
      if ((point.getVector3fMap() - place).norm() > 1.5f)
        changed.push_back(point);
    cloud = changed;
    EXPECT_TRUE(cliquesOf(generator, cloud) == cliquesOf(cloud));
    EXPECT_GT(generator.changedCubes(), 0u);
  }
  for (std::size_t i = 0; i < 5; ++i)
    cloud[i].g ^= 1;
  EXPECT_TRUE(cliquesOf(generator, cloud) == cliquesOf(cloud));
  EXPECT_LT(generator.changedCubes(), 6u);
  generator.generate(Cloud());
  EXPECT_EQ(generator.cubes(), 0u); // removed voxels leave no state
}

TEST(SupervoxelCliques, WorkWhereverTheCloudLies)
{
  // Equal except for the last bits of the positions: cubes of a map are 6.4 m wide.
  SupervoxelParameters in_map;
  in_map.fixed_cubes = true;
  const Cliques here = cliquesOf(roomAt({0.0, 0.0, 0.0}), in_map);
  for (const double shift : {0.0, -19.2, 30.5, 640.0, 1920.0}) {
    const Cloud there = roomAt(Eigen::Vector3d(shift, -shift, shift));
    const Cliques cliques = cliquesOf(there);
    expectSound(cliques, there);
    EXPECT_TRUE(cliques == here) << shift; // the lists are too long to print
    EXPECT_EQ(cliquesOf(there, in_map) == here, shift != 30.5) << shift;
  }
  for (const double far : {-1e5, 1e6, 1e7}) { // where points coincide
    const Cloud there = roomAt(Eigen::Vector3d(far, far, far));
    expectSound(cliquesOf(there), there);
  }
}

TEST(SupervoxelCliques, PointsAtTheBordersOfVoxelsAreNotLost)
{
  Cloud cloud;
  for (int i = -40; i <= 40; ++i)
    for (int j = -40; j <= 40; ++j) {
      pcl::PointXYZRGB point;
      point.getVector3fMap() << 0.1f * float(i), 0.1f * float(j), 0.0f;
      cloud.push_back(point);
    }
  const Cliques cliques = cliquesOf(cloud);
  expectSound(cliques, cloud);
  EXPECT_EQ(membersOf(cliques), cloud.size());
}

TEST(SupervoxelCliques, TakePointsThatAreNotFiniteDoubledOrAlone)
{
  EXPECT_TRUE(cliquesOf(Cloud()).empty());
  Cloud cloud;
  cloud.push_back({kNaN, 0.0f, 0.0f, 0, 0, 0});
  EXPECT_TRUE(cliquesOf(cloud).empty());
  cloud.push_back({1.0f, 2.0f, 3.0f, 0, 0, 0}); // alone: too few for a supervoxel
  EXPECT_TRUE(cliquesOf(cloud).empty());

  Cloud room = roomAt({0.0, 0.0, 0.0});
  const Cliques once = cliquesOf(room);
  Cloud doubled = room;
  doubled += room;
  const Cliques twice = cliquesOf(doubled);
  expectSound(twice, doubled);
  ASSERT_EQ(twice.size(), once.size());
  for (std::size_t c = 0; c < once.size(); ++c) {
    std::vector<int> expected = once[c];
    for (const int i : once[c])
      expected.push_back(i + int(room.size()));
    EXPECT_EQ(twice[c], expected);
  }
  for (const float bad : {kNaN, std::numeric_limits<float>::infinity()}) {
    Cloud holed = room;
    holed[7].x = bad;
    holed[8].x = bad;
    const Cliques cliques = cliquesOf(holed);
    expectSound(cliques, holed);
    EXPECT_EQ(membersOf(cliques), room.size() - 2);
  }
}

TEST(SupervoxelCliques, WhatTheClusteringLeavesOutGoesToTheNearestWithinReach)
{
  Cloud cloud = roomAt({0.0, 0.0, 0.0});
  pcl::PointXYZRGB near_one = cloud[0], far_one = cloud[0]; // above the floor
  near_one.getVector3fMap() << 1.55f, 0.55f, 0.75f;
  far_one.getVector3fMap() << 1.55f, 0.55f, 1.65f;
  cloud.push_back(near_one);
  cloud.push_back(far_one);
  const Cliques cliques = cliquesOf(cloud);
  expectSound(cliques, cloud);
  EXPECT_EQ(membersOf(cliques), cloud.size() - 1); // the far one is in none
  for (const std::vector<int>& clique : cliques)
    if (clique.back() >= int(cloud.size()) - 2) {
      EXPECT_EQ(clique.back(), int(cloud.size()) - 2);
      const int below = 2 * (15 * 30 + 5); // the point of the floor under it
      EXPECT_TRUE(std::count(clique.begin(), clique.end(), below));
    }
}

TEST(SupervoxelCliques, AnOrganizedCloudIsTreatedAsAny)
{
  Cloud cloud = roomAt({0.0, 0.0, 4.0});
  const Cliques expected = cliquesOf(cloud);
  cloud.width = 60;
  cloud.height = 60;
  EXPECT_TRUE(cliquesOf(cloud) == expected);
}

TEST(SupervoxelCliques, OtherResolutionsWork)
{
  const Cloud cloud = streetMap();
  std::size_t last = cloud.size();
  for (const auto& [seed, voxel] :
       {std::pair(0.2, 0.1), {0.4, 0.1}, {1.0, 0.2}, {3.0, 0.3}, {10.0, 0.1}}) {
    SupervoxelParameters parameters;
    parameters.seed_resolution = seed;
    parameters.voxel_resolution = voxel;
    const Cliques cliques = cliquesOf(cloud, parameters);
    expectSound(cliques, cloud);
    EXPECT_GT(membersOf(cliques), cloud.size() / 2) << seed;
    EXPECT_LT(cliques.size(), last) << seed;
    last = cliques.size();
  }
}

TEST(SupervoxelCliques, RefuseWhatCannotBe)
{
  Cloud cloud = roomAt({0.0, 0.0, 0.0});
  cloud[6].y = -1e30f;
  expectBadInput("point 6 ", [&] { cliquesOf(cloud); });
  const auto complaint = [](auto change) {
    SupervoxelParameters parameters;
    change(parameters);
    return thrownMessage<InvalidParameterException>(
        [&] { SupervoxelCliques generator(parameters); });
  };
  for (const double bad : {0.0, -1.0, 0.15, 1e9, double(kNaN)})
    EXPECT_TRUE(holds(complaint([&](auto& p) { p.seed_resolution = bad; }), "seed"));
  for (const double bad : {0.0, -1.0, 1e9, double(kNaN)})
    EXPECT_TRUE(holds(complaint([&](auto& p) { p.voxel_resolution = bad; }), "voxel"));
}
