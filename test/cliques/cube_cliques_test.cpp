// SPDX-License-Identifier: BSD-3-Clause
#include "support/clique_lists.h"
#include "support/thrown_message.h"

#include <pcl_semantic/cliques/cube_cliques.h>
#include <pcl_semantic/core/exceptions.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>

using namespace pcl_semantic;

namespace {

using Cloud = CliqueGenerator::Cloud;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Cloud
randomCloud(int points, const Eigen::Vector3f& centre, float extent)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<float> offset(-extent, extent);
  Cloud cloud;
  for (int i = 0; i < points; ++i) {
    pcl::PointXYZRGB point;
    point.getVector3fMap() =
        centre + Eigen::Vector3f(offset(random), offset(random), offset(random));
    cloud.push_back(point);
  }
  return cloud;
}

// What CubeCliques has to give, said with a map from z, y, x to the points.
Cliques
plainCubes(const Cloud& cloud, double edge)
{
  std::map<std::array<double, 3>, std::vector<int>> cubes;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const pcl::PointXYZRGB& point = cloud[i];
    if (std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z))
      cubes[{std::floor(point.z / edge), std::floor(point.y / edge),
             std::floor(point.x / edge)}]
          .push_back(int(i));
  }
  Cliques lists;
  for (const auto& [cube, points] : cubes)
    lists.push_back(points);
  return lists;
}

Cliques
cubesOf(const Cloud& cloud, double edge)
{
  return listsOf(CubeCliques(edge).generate(cloud));
}

} // namespace

// One point at exactly 0 0 0 may be real, several are no returns of a scanner.
TEST(CubeCliques, PassesOverNoReturns)
{
  Cloud cloud = randomCloud(50, {3.0f, -2.0f, 0.5f}, 5.0f);
  cloud.push_back({0.0f, 0.0f, 0.0f, 0, 0, 0});
  EXPECT_EQ(cubesOf(cloud, 100.0), plainCubes(cloud, 100.0));
  Cloud without = cloud;
  without[50].x = kNaN;
  without.push_back(without[50]);
  cloud.push_back(cloud[50]);
  EXPECT_EQ(cubesOf(cloud, 1.0), plainCubes(without, 1.0));
  EXPECT_TRUE(cubesOf(Cloud(), 1.0).empty());
}

TEST(CubeCliques, GroupsAsAPlainMapDoes)
{
  const Cloud cloud = randomCloud(20000, {3.0f, -2.0f, 0.5f}, 5.0f);
  for (const double edge : {0.1, 0.37, 1.0, 4.0, 100.0}) {
    const auto cliques = cubesOf(cloud, edge);
    EXPECT_EQ(cliques, plainCubes(cloud, edge)) << edge;
    EXPECT_GT(cliques.size(), 1u) << edge; // cubes end at 0, in the middle of the cloud
  }
}

TEST(CubeCliques, WorksFarFromTheOrigin)
{
  // Here a single-precision quotient is off by whole cubes.
  for (const float far : {-1e5f, 1e6f, 1.3e7f}) {
    const Cloud cloud = randomCloud(5000, {far, -far, 0.7f * far}, 20.0f);
    EXPECT_EQ(cubesOf(cloud, 0.3), plainCubes(cloud, 0.3)) << far;
  }
}

TEST(CubeCliques, ACubeIsHalfOpen)
{
  Cloud cloud;
  for (const float x : {-0.5f, 0.0f, 0.25f, 0.5f, -0.25f, 0.75f})
    cloud.push_back({x, 0.0f, 0.0f, 0, 0, 0});
  const Cliques expected = {{0, 4}, {1, 2}, {3, 5}};
  EXPECT_EQ(cubesOf(cloud, 0.5), expected);
}

TEST(CubeCliques, PointsThatAreNotFiniteAreInNone)
{
  Cloud cloud = randomCloud(1000, Eigen::Vector3f::Zero(), 3.0f);
  cloud[0].x = kNaN;
  cloud[500].y = std::numeric_limits<float>::infinity();
  cloud[999].z = -std::numeric_limits<float>::infinity();
  const auto cliques = cubesOf(cloud, 1.0);
  EXPECT_EQ(cliques, plainCubes(cloud, 1.0));
  EXPECT_EQ(membersOf(cliques), 997u);
}

TEST(CubeCliques, NoPointsGiveNoClique)
{
  EXPECT_TRUE(cubesOf(Cloud(), 1.0).empty());
  Cloud cloud;
  cloud.push_back({kNaN, kNaN, kNaN, 0, 0, 0});
  EXPECT_TRUE(cubesOf(cloud, 1.0).empty());
}

TEST(CubeCliques, RefusesAPointBeyondTheIndices)
{
  Cloud cloud = randomCloud(10, Eigen::Vector3f::Zero(), 3.0f);
  cloud[6].y = -1e30f;
  expectBadInput("point 6 ", [&] { cubesOf(cloud, 1.0); });
  cloud[6].y = 3.0f;
  EXPECT_EQ(cubesOf(cloud, 1e-8), plainCubes(cloud, 1e-8));
  thrownMessage<BadInputException>([&] { cubesOf(cloud, 1e-10); });
}

TEST(CubeCliques, RefusesABadEdge)
{
  for (const double edge : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN()})
    expectBadParameter("edge", [&] { CubeCliques cubes(edge); });
}

// As PCL's segmentations are used.
TEST(CubeCliques, OfAnInputCloudAndIndices)
{
  const Cloud::Ptr cloud(new Cloud(randomCloud(500, Eigen::Vector3f::Zero(), 3.0f)));
  cloud->header.frame_id = "lidar";
  CubeCliques cubes(1.0);
  std::vector<pcl::PointIndices> cliques;
  expectBadParameter("no input cloud", [&] { cubes.extract(cliques); });
  cubes.setInputCloud(cloud);
  cubes.extract(cliques);
  EXPECT_EQ(listsOf(cliques), listsOf(CubeCliques(1.0).generate(*cloud)));
  EXPECT_EQ(cliques.at(0).header.frame_id, "lidar");

  const pcl::IndicesPtr odd(new pcl::Indices);
  for (int i = 1; i < 500; i += 2)
    odd->push_back(i);
  cubes.setIndices(odd);
  cubes.extract(cliques);
  Cliques expected;
  for (std::vector<int> clique : listsOf(CubeCliques(1.0).generate(*cloud))) {
    clique.erase(
        std::remove_if(clique.begin(), clique.end(), [](int i) { return i % 2 == 0; }),
        clique.end());
    if (!clique.empty())
      expected.push_back(clique);
  }
  EXPECT_EQ(listsOf(cliques), expected);
  odd->push_back(500);
  expectBadParameter("index 500 is beyond the 500 points",
                     [&] { cubes.extract(cliques); });
}
