// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/map_cliques.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>

#include <cmath>

namespace pcl_semantic {
namespace {

const LabelSet label_set({{"road", {}}, {"wall", {}}, {"pole", {}}});

// Two cubes of 1 m: a floor at z = 0.05 m, and a wall that faces the camera 2 m on.
VoxelCloud
floorAndWall()
{
  VoxelCloud voxels;
  voxels.voxel_size = 0.1;
  for (int a = 0; a < 10; ++a)
    for (int b = 0; b < 10; ++b)
      voxels.indices.push_back({a, b, 0});
  for (int a = 0; a < 10; ++a)
    for (int b = 0; b < 10; ++b)
      voxels.indices.push_back({25, a, b});
  voxels.measured = LabelDistributions(3, Eigen::Index(voxels.size()));
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    pcl::PointXYZRGBL point;
    point.x = 0.1f * (float(voxels.indices[i].x()) + 0.5f);
    point.y = 0.1f * (float(voxels.indices[i].y()) + 0.5f);
    point.z = 0.1f * (float(voxels.indices[i].z()) + 0.5f);
    point.r = i % 2 ? 20 : 40; // on average 30
    point.g = i < 100 ? 60 : 120;
    point.b = 10;
    voxels.cloud->push_back(point);
    voxels.measured.matrix().col(Eigen::Index(i)) << (i < 100 ? 0.7f : 0.1f),
        (i < 100 ? 0.2f : 0.8f), 0.1f;
  }
  return voxels;
}

// A camera 1.5 m above the floor that looks along world x.
GroundView
viewOfFloor()
{
  GroundView view;
  view.T_world_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  view.T_world_camera.translation() = Eigen::Vector3d(-1.0, 0.5, 1.5);
  view.ground = Eigen::Hyperplane<double, 3>(Eigen::Vector3d(0, -1, 0), 1.5);
  return view;
}

std::vector<pcl::PointIndices>
halves()
{
  std::vector<pcl::PointIndices> cliques(2);
  for (int i = 0; i < 200; ++i)
    cliques[i < 100 ? 0 : 1].indices.push_back(i);
  return cliques;
}

MapperConfig
cubes()
{
  MapperConfig config;
  config.cliques = "cubes:1";
  return config;
}

TEST(CliqueEvidence, PlacesOfAFloorAndAWall)
{
  const CliqueEvidence evidence =
      cliqueEvidence(floorAndWall(), halves(), viewOfFloor());
  ASSERT_EQ(evidence.features.size(), 2u);
  EXPECT_NEAR(evidence.features[0][Feature::height], 0.05, 1e-5);
  EXPECT_NEAR(evidence.features[0][Feature::distance], 1.5, 1e-5);
  EXPECT_NEAR(evidence.features[0][Feature::level], 1.0, 1e-5);
  EXPECT_NEAR(evidence.features[1][Feature::height], 0.5, 1e-5);
  EXPECT_NEAR(evidence.features[1][Feature::distance], 3.55, 1e-5);
  EXPECT_NEAR(evidence.features[1][Feature::level], 0.0, 1e-5);
  const PointFeatures& floor = evidence.features[0];
  const PointFeatures& wall = evidence.features[1];
  EXPECT_NEAR(floor[Feature::lowest], 0.05, 1e-5);
  EXPECT_NEAR(floor[Feature::extent], 0.0, 1e-5);
  EXPECT_NEAR(wall[Feature::lowest], 0.05, 1e-5);
  EXPECT_NEAR(wall[Feature::extent], 0.9, 1e-5);
  EXPECT_NEAR(floor[Feature::side], 0.0, 1e-5); // both are before the camera
  GroundView aside = viewOfFloor();
  aside.T_world_camera.translation().y() -= 2.0; // to the right
  const CliqueEvidence left = cliqueEvidence(floorAndWall(), halves(), aside);
  EXPECT_NEAR(left.features[1][Feature::side], 2.0, 1e-5);
  EXPECT_NEAR(floor[Feature::brightness], 100.0 / 765.0, 1e-5);
  EXPECT_NEAR(floor[Feature::red], 0.3, 1e-5);
  EXPECT_NEAR(floor[Feature::green], 0.6, 1e-5);
  EXPECT_NEAR(wall[Feature::green], 0.75, 1e-5);
}

TEST(CliqueEvidence, DistributionsAreGeometricMeansOfMembersWithAMeasurement)
{
  VoxelCloud voxels = floorAndWall();
  voxels.measured.matrix().col(0) << 0.2f, 0.8f, 0.0f;
  voxels.measured.matrix().col(1) << 1.0f, 0.5f, 0.5f; // of any sum
  voxels.measured.matrix().col(2).setZero();
  std::vector<pcl::PointIndices> cliques(2);
  cliques[0].indices = {0, 1, 2};
  cliques[1].indices = {2};
  const CliqueEvidence evidence = cliqueEvidence(voxels, cliques, viewOfFloor());
  Eigen::Vector3d expected(std::sqrt(0.2 * 0.5), std::sqrt(0.8 * 0.25),
                           std::sqrt(1e-4 * 0.25));
  expected /= expected.sum();
  EXPECT_LT((evidence.distributions.matrix().col(0).cast<double>() - expected).norm(),
            1e-6);
  EXPECT_TRUE(evidence.distributions.matrix().col(1).isZero(0.0f));
}

TEST(CliqueEvidence, WhatIsNotKnown)
{
  const VoxelCloud voxels = floorAndWall();
  std::vector<pcl::PointIndices> cliques(2);
  cliques[0].indices = {0, 1};
  cliques[1].indices = {0, 1, 2, 3, 4}; // a line
  const CliqueEvidence some = cliqueEvidence(voxels, cliques, viewOfFloor());
  for (const PointFeatures& features : some.features) {
    EXPECT_TRUE(std::isfinite(features[Feature::height]));
    EXPECT_TRUE(std::isnan(features[Feature::level]));
  }
  GroundView view = viewOfFloor();
  view.ground.reset();
  const CliqueEvidence none = cliqueEvidence(voxels, halves(), view);
  EXPECT_TRUE(std::isnan(none.features[0][Feature::height]));
  EXPECT_TRUE(std::isnan(none.features[0][Feature::distance]));
  for (const Feature feature : {Feature::side, Feature::lowest, Feature::extent})
    EXPECT_TRUE(std::isnan(none.features[0][feature]));
  EXPECT_NEAR(none.features[0][Feature::red], 0.3, 1e-5); // is seen all the same
  EXPECT_NEAR(none.distributions.matrix()(0, 0), 0.7, 1e-5);
}

TEST(MapCliques, LeavesOutWhatIsLikelyOfAClass)
{
  VoxelCloud voxels = floorAndWall();
  for (int i = 0; i < 200; ++i) // all of the wall, and five of the floor
    if (i < 5 || i >= 100)
      voxels.measured.matrix().col(i) << 0.4f, 0.2f, 0.4f;
  MapperConfig config = cubes();
  EXPECT_EQ(MapCliques(config, label_set).group(voxels).size(), 2u);
  config.clique_exclude = "pole";
  const auto cliques = MapCliques(config, label_set).group(voxels);
  ASSERT_EQ(cliques.size(), 1u);
  ASSERT_EQ(cliques[0].indices.size(), 95u);
  EXPECT_EQ(cliques[0].indices[0], 5);
}

TEST(MapCliques, CostsAreThoseOfTheCalibration)
{
  const VoxelCloud voxels = floorAndWall();
  MapCliques cliques(cubes(), label_set);
  EXPECT_EQ(cliques.generate(voxels).costs.size(), 0);
  LabelCalibration calibration = LabelCalibration::identity(3);
  calibration.sharpness = 0.5f;
  calibration.bias << 0.0f, 1.0f, -1.0f;
  cliques.setCalibration(calibration);
  const MapCliques::Result result = cliques.generate(voxels);
  ASSERT_EQ(result.cliques.size(), 2u);
  ASSERT_EQ(result.costs.cols(), 2);
  Eigen::Vector3d expected(std::sqrt(0.7), std::sqrt(0.2) * std::exp(1.0),
                           std::sqrt(0.1) * std::exp(-1.0));
  expected = -(expected / expected.sum()).array().log();
  EXPECT_LT((result.costs.col(0).cast<double>() - expected).norm(), 1e-4);
}

TEST(MapCliques, SameForAnyNumberOfThreads)
{
  const VoxelCloud voxels = floorAndWall();
  MapCliques cliques(cubes(), label_set);
  cliques.setCalibration(LabelCalibration::identity(3));
  setNumberOfThreads(1);
  const Eigen::MatrixXf one = cliques.generate(voxels).costs;
  setNumberOfThreads(4);
  EXPECT_EQ(cliques.generate(voxels).costs, one);
  setNumberOfThreads(0);
}

TEST(MapCliques, RefusesWhatDoesNotFitTheLabelSet)
{
  MapperConfig config = cubes();
  config.clique_exclude = "pole,lawn";
  expectBadParameter("class 'lawn' is not in the label set",
                     [&] { MapCliques(config, label_set); });
  MapCliques cliques(cubes(), label_set);
  expectBadParameter("clique calibration of 4 classes for a map of 3",
                     [&] { cliques.setCalibration(LabelCalibration::identity(4)); });
}

} // namespace
} // namespace pcl_semantic
