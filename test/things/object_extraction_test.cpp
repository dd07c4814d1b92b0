// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/object_extraction.h>

#include "support/named_classes.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/things/connected_points.h>

#include <gtest/gtest.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <set>

namespace pcl_semantic {

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZL>;

// Groups of five points; some are nearer to each other than a gap.
std::vector<Eigen::Vector3d>
randomPoints(unsigned seed, std::size_t count)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] {
    const double x = uniform(random), y = uniform(random);
    return Eigen::Vector3d(x, y, uniform(random));
  };
  std::vector<Eigen::Vector3d> points;
  while (points.size() < count) {
    const Eigen::Vector3d centre = 3.0 * vector();
    for (int i = 0; i < 5; ++i)
      points.push_back(centre + 0.4 * vector());
  }
  return points;
}

// Compares all pairs until nothing changes.
std::vector<int>
plainComponents(const std::vector<Eigen::Vector3d>& points, double gap)
{
  std::vector<int> component(points.size());
  std::iota(component.begin(), component.end(), 0);
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < points.size(); ++j)
        if ((points[i] - points[j]).norm() <= gap && component[i] < component[j]) {
          component[j] = component[i];
          is_changed = true;
        }
  }
  return component;
}

// Whether two numberings group the same points.
bool
areSameGroups(const std::vector<int>& a, const std::vector<int>& b)
{
  std::set<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < a.size(); ++i)
    pairs.emplace(a[i], b[i]);
  return pairs.size() == std::set<int>(a.begin(), a.end()).size() &&
         pairs.size() == std::set<int>(b.begin(), b.end()).size();
}

struct TestPoint {
  float x;
  unsigned label;
};

Cloud::Ptr
lineOf(const std::vector<TestPoint>& points)
{
  Cloud::Ptr cloud(new Cloud);
  for (const TestPoint& each : points) {
    pcl::PointXYZL point;
    point.x = each.x;
    point.y = 0.0f;
    point.z = 1.0f;
    point.label = each.label;
    cloud->push_back(point);
  }
  return cloud;
}

std::vector<pcl::Indices>
objectsOf(ObjectExtraction<pcl::PointXYZL>& extraction, const Cloud::Ptr& cloud)
{
  extraction.setInputCloud(cloud);
  std::vector<pcl::PointIndices> objects;
  extraction.extract(objects);
  std::vector<pcl::Indices> indices;
  for (const pcl::PointIndices& object : objects)
    indices.push_back(object.indices);
  return indices;
}

// 1 road, 2 car, 3 person.
LabelSet
roadCarPerson()
{
  std::vector<LabelClass> classes = namedClasses({"road", "car", "person"});
  classes[1].thing = classes[2].thing = true;
  classes[2].gap = 0.3;
  return LabelSet(classes);
}

} // namespace

TEST(ConnectedComponents, AreThoseOfAllPairs)
{
  std::size_t groups = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const auto points = randomPoints(seed, 150);
    for (const double gap : {0.05, 0.5, 0.8, 3.0}) {
      const std::vector<int> components = connectedComponents(points, gap);
      EXPECT_TRUE(areSameGroups(components, plainComponents(points, gap)))
          << seed << " " << gap;
      groups += std::size_t(*std::max_element(components.begin(), components.end()));
    }
  }
  EXPECT_GT(groups, 1000u);
}

TEST(ConnectedComponents, AGapIsInclusiveAndPointsMayCoincide)
{
  const auto atDistance = [](double distance) {
    return connectedComponents({{7, -3, 2}, {7 + distance, -3, 2}, {7, -3, 2}}, 0.5);
  };
  EXPECT_EQ(atDistance(0.5), (std::vector<int>{0, 0, 0}));
  EXPECT_EQ(atDistance(0.5 + 1e-9), (std::vector<int>{0, 1, 0}));
  EXPECT_TRUE(connectedComponents({}, 1.0).empty());
}

TEST(ConnectedComponents, NumbersDoNotDependOnTheOrder)
{
  const auto points = randomPoints(3, 200);
  const std::vector<int> expected = connectedComponents(points, 0.4);
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  std::vector<Eigen::Vector3d> shuffled;
  for (const std::size_t i : order)
    shuffled.push_back(points[i]);
  const std::vector<int> components = connectedComponents(shuffled, 0.4);
  for (std::size_t i = 0; i < order.size(); ++i)
    EXPECT_EQ(components[i], expected[order[i]]);
}

TEST(ConnectedComponents, RefusesGapsAndExtents)
{
  for (const double gap : {0.0, -1.0, HUGE_VAL, std::nan("")})
    EXPECT_THROW(connectedComponents({{0, 0, 0}}, gap), InvalidParameterException);
  EXPECT_TRUE(holds(thrownMessage<BadInputException>([] {
                      connectedComponents({{0, 0, 0}, {1e7, 0, 0}}, 0.1);
                    }),
                    "objects extend over 1e+07 m"));
}

TEST(ObjectExtraction, GroupsEachClassOfThings)
{
  // A car with road and a person within it, a person at more than its gap, another car.
  const Cloud::Ptr cloud = lineOf({{0.0f, 2},
                                   {0.5f, 2},
                                   {0.6f, 1},
                                   {0.6f, 3},
                                   {1.0f, 3},
                                   {1.1f, 2},
                                   {2.0f, 2},
                                   {0.2f, 0}});
  ObjectExtraction<pcl::PointXYZL> extraction;
  extraction.setLabelSet(roadCarPerson());
  EXPECT_EQ(objectsOf(extraction, cloud),
            (std::vector<pcl::Indices>{{0, 1, 5}, {3}, {4}, {6}}));
  extraction.setMinClusterSize(2);
  EXPECT_EQ(objectsOf(extraction, cloud), (std::vector<pcl::Indices>{{0, 1, 5}}));
  extraction.setGap(0.45);
  EXPECT_TRUE(objectsOf(extraction, cloud).empty());
  ObjectExtraction<pcl::PointXYZL> all; // without a label set
  EXPECT_EQ(objectsOf(all, cloud),
            (std::vector<pcl::Indices>{{0, 1, 5}, {2}, {3, 4}, {6}}));
}

TEST(ObjectExtraction, UsesIndicesAndSkipsPointsWithoutAPlace)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Cloud::Ptr cloud = lineOf({{0.0f, 1}, {nan, 1}, {0.5f, 1}, {1.0f, 1}});
  ObjectExtraction<pcl::PointXYZL> extraction;
  EXPECT_EQ(objectsOf(extraction, cloud), (std::vector<pcl::Indices>{{0, 2, 3}}));
  extraction.setIndices(pcl::make_shared<pcl::Indices>(pcl::Indices{3, 0, 3}));
  EXPECT_EQ(objectsOf(extraction, cloud), (std::vector<pcl::Indices>{{0}, {3}}));
}

TEST(ObjectExtraction, RefusesInvalidInput)
{
  ObjectExtraction<pcl::PointXYZL> extraction;
  std::vector<pcl::PointIndices> objects;
  EXPECT_THROW(extraction.extract(objects), InvalidParameterException);
  extraction.setInputCloud(lineOf({{0.0f, 256}}));
  EXPECT_THROW(extraction.extract(objects), InvalidParameterException);
  extraction.setInputCloud(lineOf({{0.0f, 1}}));
  extraction.setIndices(pcl::make_shared<pcl::Indices>(pcl::Indices{1}));
  EXPECT_THROW(extraction.extract(objects), InvalidParameterException);
  EXPECT_THROW(extraction.setGap(0.0), InvalidParameterException);
  EXPECT_THROW(
      extraction.setLabelSet(LabelSet(std::vector<LabelClass>(1, {"road", {}}))),
      InvalidParameterException);
}

} // namespace pcl_semantic
