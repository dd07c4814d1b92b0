// SPDX-License-Identifier: BSD-3-Clause
#include "filters/crf_region.h"

#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace {

using namespace pcl_semantic;

constexpr int classes = 4;
constexpr double voxel_size = 0.1;

std::mt19937 generator(5); // NOLINT: the same cloud every time

float
uniform()
{
  return std::uniform_real_distribution<float>(0.01f, 1.0f)(generator);
}

// A wavy floor of 8 x 3 m, all of it refined.
VoxelCloud
floorVoxels()
{
  VoxelCloud voxels;
  for (int y = -15; y < 15; ++y)
    for (int x = -40; x < 40; ++x)
      if (uniform() < 0.8f)
        voxels.indices.emplace_back(x, y, (x / 7 + y / 5) % 3);
  voxels.voxel_size = voxel_size;
  voxels.measured = LabelDistributions(classes, Eigen::Index(voxels.size()));
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    pcl::PointXYZRGBL point;
    point.getVector3fMap() = voxels.centre(i);
    point.r = point.g = point.b = std::uint8_t(20.0f * uniform());
    voxels.cloud->push_back(point);
    for (int k = 0; k < classes; ++k)
      voxels.measured.column(Eigen::Index(i))[k] = uniform();
  }
  voxels.refined = voxels.measured;
  voxels.is_refined.assign(voxels.size(), 1);
  return voxels;
}

// Adds measurements to the voxels of a ball.
void
measure(VoxelCloud& voxels, const Eigen::Vector3f& centre, float radius)
{
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if ((voxels.centre(i) - centre).norm() < radius) {
      voxels.is_refined[i] = 0;
      for (int k = 0; k < classes; ++k)
        voxels.measured.column(Eigen::Index(i))[k] = uniform();
    }
}

Eigen::MatrixXf
refine(const VoxelCloud& voxels, const SemanticCRFParameters& parameters,
       const pcl::Indices* seen)
{
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setModel(CRFModelType::dense);
  crf.setParameters(parameters);
  crf.setVoxels(voxels.indices, voxels.voxel_size);
  crf.setInputCloud(voxels.cloud);
  if (seen)
    crf.setIndices(pcl::make_shared<pcl::Indices>(*seen));
  crf.setLabelDistributions(voxels.measured);
  pcl::PointCloud<pcl::PointXYZRGBL> result;
  crf.filter(result);
  return crf.getLabelDistributions().matrix();
}

TEST(CrfRegion, IsWholeBlocksAroundWhatIsNotRefined)
{
  VoxelCloud voxels = floorVoxels();
  measure(voxels, {0.9f, 0.2f, 0.1f}, 0.2f);
  measure(voxels, {-3.0f, -1.0f, 0.1f}, 0.2f);
  std::set<std::array<int, 3>> changed;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (!voxels.is_refined[i]) {
      const VoxelIndex block = blockOf(voxels.indices[i]);
      changed.insert({block.x(), block.y(), block.z()});
    }
  ASSERT_GE(changed.size(), 2u);
  const auto blocksFromChange = [&](std::size_t i) {
    int least = 1000;
    const VoxelIndex block = blockOf(voxels.indices[i]);
    for (const auto& [x, y, z] : changed)
      least = std::min(least, (block - VoxelIndex(x, y, z)).cwiseAbs().maxCoeff());
    return least;
  };
  for (const int blocks : {1, 2}) {
    pcl::Indices updated, seen;
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      if (blocksFromChange(i) <= blocks)
        updated.push_back(pcl::index_t(i));
      if (blocksFromChange(i) <= 2 * blocks)
        seen.push_back(pcl::index_t(i));
    }
    const CrfRegion region = crfRegion(voxels, blocks * kBlockEdge * voxel_size);
    EXPECT_EQ(region.updated, updated) << blocks;
    EXPECT_EQ(region.seen, seen) << blocks;
    EXPECT_LT(updated.size(), seen.size());
  }
}

TEST(CrfRegion, IsNothingWhereNothingWasMeasuredAndAllWhereNothingIsKnown)
{
  VoxelCloud voxels = floorVoxels();
  EXPECT_TRUE(crfRegion(voxels, 1.0).updated.empty());
  EXPECT_TRUE(crfRegion(VoxelCloud(), 1.0).updated.empty());
  voxels.is_refined.clear(); // as in a cloud that comes from a file
  EXPECT_EQ(crfRegion(voxels, 1.0).updated.size(), voxels.size());
  voxels.is_refined.assign(voxels.size(), 1);
  voxels.is_refined[7] = 0;
  EXPECT_EQ(crfRegion(voxels, 1e30).updated.size(), voxels.size());
}

// The plain way is to refine all of it again. What differs are weights that are rounded
// (to 8 bits) another way, as positions are counted from another corner.
TEST(CrfRegion, GivesWhatARunOverAllWouldGive)
{
  for (const int iterations : {1, 2}) {
    SemanticCRFParameters parameters = SemanticCRFParameters::forMaps();
    parameters.iterations = iterations;
    parameters.logit_adjustment = 0.0; // frequencies change with every measurement
    VoxelCloud voxels = floorVoxels();
    const Eigen::MatrixXf before = refine(voxels, parameters, nullptr);
    measure(voxels, {-2.7f, 0.0f, 0.1f}, 0.3f);
    const Eigen::MatrixXf all = refine(voxels, parameters, nullptr);
    const auto errorWith = [&](double reach) {
      const CrfRegion region = crfRegion(voxels, reach);
      EXPECT_LT(region.seen.size(), voxels.size()) << "asks for nothing";
      const Eigen::MatrixXf some = refine(voxels, parameters, &region.seen);
      Eigen::MatrixXf kept = before;
      for (const pcl::index_t i : region.updated)
        kept.col(i) = some.col(i);
      return (all - kept).cwiseAbs().maxCoeff();
    };
    EXPECT_LT(errorWith(crfReach(parameters, voxel_size)), 2e-4f) << iterations;
    EXPECT_GT(errorWith(0.0), 1e-2f) << iterations;
  }
}

} // namespace
