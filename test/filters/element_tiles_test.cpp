// SPDX-License-Identifier: BSD-3-Clause
#include "filters/element_tiles.h"
#include "support/plain_cloud_crf.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <string>

using namespace pcl_semantic;

namespace {

std::vector<ElementTile>
tilesOf(const Eigen::MatrixXf& positions, double reach, std::size_t most)
{
  std::vector<ElementTile> tiles;
  TileLimits limits;
  limits.reach = reach;
  limits.most = most;
  forEachTile(positions, limits,
              [&](const ElementTile& tile) { tiles.push_back(tile); });
  return tiles;
}

Eigen::MatrixXf
randomPositions(Eigen::Index rows, Eigen::Index count)
{
  return makeRandomMatrix(rows, count, -3.0f, 5.0f, 7);
}

// Tests every element against the box of a tile.
pcl::Indices
haloOf(const Eigen::MatrixXf& positions, const pcl::Indices& own, float reach)
{
  Eigen::ArrayXf low = positions.col(own[0]), high = low;
  for (const pcl::index_t i : own) {
    low = low.min(positions.col(i).array());
    high = high.max(positions.col(i).array());
  }
  const std::set<pcl::index_t> inside(own.begin(), own.end());
  pcl::Indices halo;
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    if (inside.count(pcl::index_t(i)) == 0 &&
        (positions.col(i).array() >= low - reach).all() &&
        (positions.col(i).array() <= high + reach).all())
      halo.push_back(pcl::index_t(i));
  return halo;
}

} // namespace

TEST(ElementTiles, ContainEachElementOnceAndTheirWholeHalo)
{
  for (const Eigen::Index rows : {1, 2, 3}) {
    const Eigen::MatrixXf positions = randomPositions(rows, 1000);
    std::vector<int> owners(1000, 0);
    const std::vector<ElementTile> tiles = tilesOf(positions, 0.1, 90);
    EXPECT_EQ(tiles.size(), 12u);
    for (const ElementTile& tile : tiles) {
      EXPECT_LE(tile.own.size(), 90u);
      EXPECT_GE(tile.own.size(), 80u) << "parts are equal";
      for (const pcl::index_t i : tile.own)
        ++owners[std::size_t(i)];
      pcl::Indices halo = tile.halo;
      std::sort(halo.begin(), halo.end());
      EXPECT_EQ(halo, haloOf(positions, tile.own, 0.1f));
    }
    EXPECT_EQ(owners, std::vector<int>(1000, 1));
  }
}

TEST(ElementTiles, DoNotDependOnTheOrder)
{
  const Eigen::MatrixXf positions = randomPositions(3, 500);
  const Eigen::MatrixXf reversed = positions.rowwise().reverse();
  const auto setsOf = [](const std::vector<ElementTile>& tiles, bool reverse) {
    std::set<std::set<pcl::index_t>> sets;
    for (const ElementTile& tile : tiles) {
      std::set<pcl::index_t> own;
      for (const pcl::index_t i : tile.own)
        own.insert(reverse ? 499 - i : i);
      sets.insert(own);
    }
    return sets;
  };
  EXPECT_EQ(setsOf(tilesOf(positions, 0.2, 60), false),
            setsOf(tilesOf(reversed, 0.2, 60), true));
}

TEST(ElementTiles, ElementsAtOnePlaceStayTogether)
{
  Eigen::MatrixXf positions = Eigen::MatrixXf::Constant(3, 200, 1.5f);
  EXPECT_EQ(tilesOf(positions, 1.0, 10).size(), 1u);
  positions.rightCols(90).row(1).setConstant(9.0f);
  const std::vector<ElementTile> tiles = tilesOf(positions, 1.0, 10);
  ASSERT_EQ(tiles.size(), 2u);
  EXPECT_EQ(tiles[0].own.size(), 110u);
  EXPECT_EQ(tiles[1].own.size(), 90u);
  EXPECT_TRUE(tilesOf(Eigen::MatrixXf(3, 0), 1.0, 10).empty());
}

// Clusters of 300, 500 and 200 elements far apart, and one element far from all.
TEST(ElementTiles, WideOnesAreDividedAtGaps)
{
  Eigen::MatrixXf positions = randomPositions(3, 1001);
  positions.middleCols(300, 500).row(0).array() += 20000.0f;
  positions.middleCols(800, 200).row(1).array() += 20000.0f;
  positions(2, 1000) = -5e6f;
  TileLimits limits;
  limits.reach = 5.0; // as wide as the clusters
  limits.most = 1000;
  limits.widest = 1000.0;
  std::multiset<std::size_t> sizes;
  forEachTile(positions, limits, [&](const ElementTile& tile) {
    sizes.insert(tile.own.size());
    EXPECT_TRUE(tile.halo.empty());
  });
  EXPECT_EQ(sizes, (std::multiset<std::size_t>{1, 200, 300, 500}));
}

TEST(ElementTiles, ATileWithAWideHaloIsNotDivided)
{
  const Eigen::MatrixXf positions = randomPositions(3, 1000);
  const std::vector<ElementTile> tiles = tilesOf(positions, 5.0, 90);
  ASSERT_EQ(tiles.size(), 1u);
  EXPECT_EQ(tiles[0].own.size(), 1000u);
  EXPECT_TRUE(tiles[0].halo.empty());
}

namespace {

struct TiledCase {
  std::string name;
  KernelMethod method;
  int updates;
};

class TiledKernels : public testing::TestWithParam<TiledCase> {};

} // namespace

TEST_P(TiledKernels, HasTheLabelsOfARunInOnePiece)
{
  CrfCloud input = makeCrfCloud(8000, 3);
  for (std::size_t i = 0; i < 8000; ++i) { // a long row of parts of 1000 voxels
    const pcl::PointXYZRGBL& first = (*input.cloud)[i % 1000];
    (*input.cloud)[i].getVector3fMap() = first.getVector3fMap();
    (*input.cloud)[i].x += 2.0f * float(i / 1000);
  }
  std::mt19937 random(3);
  for (Eigen::Index i = 0; i < 8000;
       ++i) { // cubes of 0.5 m, a quarter of the labels wrong
    const Eigen::Vector3f cube =
        ((*input.cloud)[std::size_t(i)].getVector3fMap() * 2.0f).array().floor();
    const int own = (int(cube.sum()) % 4 + 4) % 4;
    const int label = random() % 4 == 0 ? int(random() % 4) : own;
    input.distributions.setLabel(i, Label(label + 1), 0.7f);
  }
  (*input.cloud)[5].x = std::numeric_limits<float>::quiet_NaN();
  input.distributions.matrix().col(40).setZero();
  SemanticCRFParameters parameters;
  parameters.kernel_method = GetParam().method;
  parameters.iterations = GetParam().updates;
  CrfFilter crf = filterWith(parameters);
  pcl::PointCloud<pcl::PointXYZRGBL> whole, tiled;
  const Eigen::MatrixXf expected = refine(crf, input, &whole);
  const CRFReport report = crf.getReport();
  crf.setTileSize(8000);
  EXPECT_TRUE(refine(crf, input) == expected);
  crf.setTileSize(1500);
  const Eigen::MatrixXf found = refine(crf, input, &tiled);
  EXPECT_EQ(crf.getReport().spacing, report.spacing);
  EXPECT_EQ(crf.getReport().updates, report.updates);
  EXPECT_EQ(crf.getReport().unlabelled, report.unlabelled);
  std::size_t equal = 0;
  for (std::size_t i = 0; i < whole.size(); ++i)
    equal += whole[i].label == tiled[i].label;
  EXPECT_GE(equal, whole.size() - 8); // 99.9 %, in much smaller tiles than usual
  EXPECT_LT((found - expected).cwiseAbs().mean(), 3e-4f);
  EXPECT_FALSE(found == expected) << "there were no tiles";

  crf.setNumberOfThreads(1);
  EXPECT_TRUE(refine(crf, input) == found);
  crf.setNumberOfThreads(3);
  EXPECT_TRUE(refine(crf, input) == found);
}

INSTANTIATE_TEST_SUITE_P(Kernels, TiledKernels,
                         testing::Values(TiledCase{"truncated", KernelMethod::truncated,
                                                   3},
                                         TiledCase{"lattice", KernelMethod::lattice, 3},
                                         TiledCase{"once", KernelMethod::truncated, 1}),
                         [](const auto& each) { return each.param.name; });

TEST(TiledCRF, EndsAtAnInterruption)
{
  struct Stop {};
  const CrfCloud input = makeCrfCloud(2000, 3);
  for (std::size_t i = 0; i < 2000; ++i) // apart, so that tiles are worthwhile
    (*input.cloud)[i].x += 10.0f * float(i % 10);
  std::size_t steps_of_one_piece = 0;
  for (const std::size_t tile : {2000u, 200u}) {
    CrfFilter crf = filterWith({});
    crf.setTileSize(tile);
    const Eigen::MatrixXf expected = refine(crf, input);
    std::size_t calls = 0;
    crf.setInterruptionCheck([&] { ++calls; });
    EXPECT_TRUE(refine(crf, input) == expected);
    const std::size_t steps = calls;
    EXPECT_GT(steps, std::size_t(crf.getReport().updates));
    EXPECT_GT(steps, steps_of_one_piece);
    steps_of_one_piece = steps;
    for (const std::size_t last : {std::size_t(1), steps / 2, steps}) {
      calls = 0;
      crf.setInterruptionCheck([&] {
        if (++calls == last)
          throw Stop();
      });
      EXPECT_THROW(refine(crf, input), Stop);
      EXPECT_EQ(calls, last);
    }
    crf.setInterruptionCheck(nullptr);
    EXPECT_TRUE(refine(crf, input) == expected);
  }
}

TEST(TiledCRF, OwnKernelsAreOfTheWholeCloud)
{
  const CrfCloud input = makeCrfCloud(500, 3);
  CrfFilter crf = filterWith({});
  crf.addKernel(makeRandomMatrix(2, 500, 0.0f, 3.0f, 4), 2.0f);
  const Eigen::MatrixXf expected = refine(crf, input);
  crf.setTileSize(100);
  EXPECT_TRUE(refine(crf, input) == expected);
  EXPECT_THROW(crf.setTileSize(0), InvalidParameterException);
}
