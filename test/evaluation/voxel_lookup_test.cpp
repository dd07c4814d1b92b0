// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/voxel_lookup.h>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace pcl_semantic {

namespace {

// Random voxels around the origin; every third is occupied.
VoxelCloud
someVoxels(double voxel_size)
{
  VoxelCloud voxels;
  voxels.voxel_size = voxel_size;
  std::mt19937 random(2);
  for (int z = -4; z < 5; ++z)
    for (int y = -5; y < 4; ++y)
      for (int x = -6; x < 5; ++x)
        if (random() % 12 == 0)
          voxels.indices.emplace_back(x, y, z);
  return voxels;
}

// All voxels, one by one: distance of the point to the nearest cube.
double
nearestDistance(const VoxelCloud& voxels, const Eigen::Vector3d& point)
{
  double least = 1e9;
  for (const VoxelIndex& index : voxels.indices) {
    double squared = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double below = index[axis] * voxels.voxel_size - point[axis];
      const double above = point[axis] - (index[axis] + 1) * voxels.voxel_size;
      squared += std::pow(std::max({below, above, 0.0}), 2);
    }
    least = std::min(least, std::sqrt(squared));
  }
  return least;
}

} // namespace

TEST(VoxelLookup, FindsTheVoxelThatHoldsAPoint)
{
  const VoxelCloud voxels = someVoxels(0.25);
  const VoxelLookup lookup(voxels);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.6, 1.6);
  int found = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d point(uniform(random), uniform(random), uniform(random));
    std::int32_t expected = VoxelLookup::none;
    for (std::size_t j = 0; j < voxels.size(); ++j)
      if ((point.array() >= voxels.indices[j].cast<double>().array() * 0.25).all() &&
          (point.array() < (voxels.indices[j].cast<double>().array() + 1.0) * 0.25)
              .all())
        expected = std::int32_t(j);
    ASSERT_EQ(lookup.at(point), expected);
    ASSERT_EQ(lookup.nearest(point, 0.0), expected);
    found += expected != VoxelLookup::none;
  }
  EXPECT_GT(found, 50);
  EXPECT_EQ(lookup.at({1e300, 0, 0}), VoxelLookup::none);
  EXPECT_EQ(lookup.at(Eigen::Vector3d::Constant(NAN)), VoxelLookup::none);
  EXPECT_EQ(lookup.nearest(Eigen::Vector3d::Constant(NAN), 1.0), VoxelLookup::none);
}

TEST(VoxelLookup, FindsTheNearestCubeWithin)
{
  const VoxelCloud voxels = someVoxels(0.25);
  const VoxelLookup lookup(voxels);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-2.5, 2.5);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 2000; ++i)
    points.emplace_back(uniform(random), uniform(random), uniform(random));
  const std::vector<std::int32_t> indices = lookup.indices(points, 0.4);
  std::set<bool> both;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double least = nearestDistance(voxels, points[i]);
    both.insert(least <= 0.4);
    if (least > 0.4) {
      ASSERT_EQ(indices[i], VoxelLookup::none) << least;
      continue;
    }
    ASSERT_NE(indices[i], VoxelLookup::none) << least;
    VoxelCloud found = voxels;
    found.indices = {voxels.indices[std::size_t(indices[i])]};
    ASSERT_NEAR(nearestDistance(found, points[i]), least, 1e-9);
  }
  EXPECT_EQ(both.size(), 2u);
}

TEST(VoxelLookup, LabelsOfPlaces)
{
  const std::vector<Label> labels = {4, 0, 7};
  const std::vector<std::int32_t> list = {2, -1, 0, 1};
  EXPECT_EQ(labelsAt(list, labels), (std::vector<Label>{7, 0, 4, 0}));
  const cv::Mat1i indices = (cv::Mat1i(2, 2) << 2, -1, 0, 1);
  const cv::Mat1b image = labelsAt(cv::Mat(indices), labels);
  EXPECT_EQ(image(0, 0), 7);
  EXPECT_EQ(image(0, 1), 0);
  EXPECT_EQ(image(1, 0), 4);
}

TEST(MapLabels, AreThoseBeforeAndAfter)
{
  VoxelCloud voxels;
  voxels.voxel_size = 1.0;
  voxels.indices = {{0, 0, 0}, {0, 0, 3}};
  voxels.measured = LabelDistributions(3, 2);
  voxels.measured.setLabel(0, 2, 0.8f);
  voxels.cloud->resize(2);
  (*voxels.cloud)[0].label = 3;
  const MapLabels labels(voxels);
  EXPECT_EQ(labels.measured, (std::vector<Label>{2, 0}));
  EXPECT_EQ(labels.refined, (std::vector<Label>{3, 0}));
  EXPECT_EQ(labels.lookup.at({0.5, 0.5, 3.5}), 1);
}

} // namespace pcl_semantic
