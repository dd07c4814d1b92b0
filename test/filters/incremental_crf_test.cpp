// SPDX-License-Identifier: BSD-3-Clause
#include "support/street_scans.h"

#include <pcl_semantic/filters/semantic_crf.h>

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace pcl_semantic;
using Crf = SemanticCRF<pcl::PointXYZRGBL>;

// Sums over other parts of a cloud round otherwise, and a weight of 8 bits may then be
// rounded to its neighbour.
constexpr float rounding = 2e-3f;

Eigen::MatrixXf
run(Crf& crf, const VoxelCloud& voxels)
{
  crf.setInputCloud(voxels.cloud);
  crf.setLabelDistributions(voxels.measured);
  pcl::PointCloud<pcl::PointXYZRGBL> output;
  crf.filter(output);
  return crf.getLabelDistributions().matrix();
}

float
differenceFromANewRun(Crf& incremental, const VoxelCloud& voxels)
{
  Crf anew;
  anew.setParameters(incremental.getParameters());
  return (run(incremental, voxels) - run(anew, voxels)).cwiseAbs().maxCoeff();
}

TEST(IncrementalCRF, FollowsAGrowingMap)
{
  SemanticVoxelMap map(readLabelSet(std::string(PCL_SEMANTIC_SOURCE_DIR) +
                                    "/data/label_sets/kitti11.yaml"),
                       SemanticVoxelMap::Parameters());
  Crf crf;
  crf.setIncremental(true);
  for (const StreetScan& scan : makeStreetScans(4, 310, 94)) {
    map.integrate(*scan.cloud, scan.T_world_camera, scan.distributions);
    EXPECT_LT(differenceFromANewRun(crf, map.occupied()), rounding);
  }
}

TEST(IncrementalCRF, FollowsPointsThatComeGoAndChange)
{
  VoxelCloud voxels = makeStreetMap(2, 310, 94);
  const auto keep = [&](auto&& wanted) { // drops the points that are not
    pcl::PointCloud<pcl::PointXYZRGBL>::Ptr cloud(
        new pcl::PointCloud<pcl::PointXYZRGBL>);
    std::vector<int> columns;
    for (std::size_t i = 0; i < voxels.cloud->size(); ++i)
      if (wanted((*voxels.cloud)[i])) {
        cloud->push_back((*voxels.cloud)[i]);
        columns.push_back(int(i));
      }
    voxels.cloud = cloud;
    voxels.measured.matrix() = voxels.measured.matrix()(Eigen::all, columns).eval();
  };
  const VoxelCloud whole = voxels;
  Crf crf;
  crf.setIncremental(true);
  run(crf, voxels);
  const float middle = (*voxels.cloud)[voxels.cloud->size() / 2].x;
  keep([&](const auto& point) { return std::abs(point.x - middle) > 0.3f; });
  ASSERT_LT(voxels.cloud->size(), whole.cloud->size());
  EXPECT_LT(differenceFromANewRun(crf, voxels), rounding);
  voxels.cloud = whole.cloud->makeShared(); // they come back, some in another colour
  voxels.measured = whole.measured;
  for (auto& point : *voxels.cloud)
    if (std::abs(point.x - middle) < 0.5f)
      point.r = std::uint8_t(255 - point.r);
  EXPECT_LT(differenceFromANewRun(crf, voxels), rounding);
  EXPECT_EQ(run(crf, voxels), run(crf, voxels)); // nothing changes
  for (auto& point : *voxels.cloud)              // all move
    point.x += 1000.0f;
  EXPECT_LT(differenceFromANewRun(crf, voxels), rounding);
}

TEST(IncrementalCRF, OtherParametersBeginAnew)
{
  const VoxelCloud voxels = makeStreetMap(1, 310, 94);
  Crf crf, anew;
  crf.setIncremental(true);
  run(crf, voxels);
  SemanticCRFParameters parameters;
  parameters.appearance_weight = 1.0;
  crf.setParameters(parameters);
  anew.setParameters(parameters);
  EXPECT_EQ(run(crf, voxels), run(anew, voxels));
}

TEST(IncrementalCRF, HasTheWholeModel)
{
  VoxelCloud voxels = makeStreetMap(2, 310, 94);
  Eigen::MatrixXf costs =
      Eigen::MatrixXf::Ones(11, 11) - Eigen::MatrixXf::Identity(11, 11);
  costs(0, 1) = costs(1, 0) = 0.3f;
  SemanticCRFParameters parameters;
  parameters.self_interaction = true;
  parameters.normalization = Normalization::one_sided;
  Crf crf, anew;
  for (Crf* filter : {&crf, &anew}) {
    filter->setParameters(parameters);
    filter->setCompatibility(costs);
  }
  crf.setIncremental(true);
  EXPECT_EQ(run(crf, voxels), run(anew, voxels));
  voxels.measured.matrix().col(0).reverseInPlace();
  const Eigen::MatrixXf expected = run(anew, voxels);
  EXPECT_LT((run(crf, voxels) - expected).cwiseAbs().maxCoeff(), rounding);
  EXPECT_GT(crf.getReport().taken_over, 0u);
}

TEST(IncrementalCRF, WhatAChangeCannotReachIsTakenOver)
{
  const VoxelCloud voxels = makeStreetMap(2, 310, 94);
  Crf crf;
  crf.setIncremental(true);
  const Eigen::MatrixXf before = run(crf, voxels);
  EXPECT_EQ(crf.getReport().taken_over, 0u);
  VoxelCloud changed = voxels;
  changed.measured.matrix().col(0).reverseInPlace();
  const Eigen::MatrixXf after = run(crf, changed);
  EXPECT_GT(crf.getReport().taken_over, voxels.size() / 2);
  EXPECT_LT(crf.getReport().taken_over, voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const float distance =
        ((*voxels.cloud)[i].getVector3fMap() - (*voxels.cloud)[0].getVector3fMap())
            .norm();
    if (distance > 4.0f) {
      EXPECT_TRUE(before.col(Eigen::Index(i)) == after.col(Eigen::Index(i)));
    }
  }
}

} // namespace
