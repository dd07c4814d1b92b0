// SPDX-License-Identifier: BSD-3-Clause
#include "io/cloud_row_writer.h"
#include "io/cloud_tiles.h"

#include "support/temporary_folder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/cloud_file.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <set>

using namespace pcl_semantic;

namespace {

constexpr std::size_t kPoints = 30000;

// Points in a box of 10 x 6 x 2 m with their numbers; every thousandth has no position.
PcdTable
numberedPoints()
{
  std::mt19937 random(2);
  const auto uniform = [&](float largest) {
    return float(random() >> 8) * 0x1p-24f * largest;
  };
  std::vector<float> x, y, z;
  std::vector<std::uint32_t> numbers;
  std::vector<std::uint8_t> labels;
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    x.push_back(i % 1000 == 7 ? std::numeric_limits<float>::infinity()
                              : uniform(10.0f));
    y.push_back(uniform(6.0f));
    z.push_back(uniform(2.0f));
    numbers.push_back(i);
    labels.push_back(std::uint8_t(1 + i % 3));
  }
  PcdTable table;
  table.width = kPoints;
  table.height = 1;
  table.setColumn("x", x);
  table.setColumn("y", y);
  table.setColumn("z", z);
  table.setColumn("number", numbers);
  table.setColumn("label", labels);
  return table;
}

class CloudTilesTest : public testing::Test {
protected:
  CloudTilesTest() { writeCloudTable(path, table); }

  Eigen::Vector3d
  positionOf(std::size_t i) const
  {
    Eigen::Vector3d position;
    for (int axis = 0; axis < 3; ++axis)
      position[axis] = PcdColumn(table, axis)(i);
    return position;
  }

  std::unique_ptr<CloudTiles>
  divide(const TileOptions& options)
  {
    PcdReader reader(path);
    const CloudSurvey survey = surveyCloud(reader, nullptr, step);
    return std::make_unique<CloudTiles>(reader, survey, options, folder.path(""), step);
  }

  const TemporaryFolder folder;
  const std::string path = folder.path("cloud.pcd");
  const PcdTable table = numberedPoints();
  int steps = 0;
  const std::function<void()> step = [this] { ++steps; };
};

std::vector<std::size_t>
numbersOf(const CloudTile& tile)
{
  const PcdColumn column(tile.table, tile.table.find("number"));
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < tile.table.points(); ++i)
    numbers.push_back(std::size_t(column(i)));
  return numbers;
}

} // namespace

TEST_F(CloudTilesTest, HaveEachPointOnceAndAllPointsAroundTheirOwn)
{
  TileOptions options;
  options.reach = 0.5;
  options.most = 6000;
  const auto divided = divide(options);
  const CloudTiles& tiles = *divided;
  EXPECT_GT(tiles.size(), 5u);
  std::vector<int> owners(kPoints, 0);
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const CloudTile tile = tiles.read(t);
    const std::vector<std::size_t> numbers = numbersOf(tile);
    const std::size_t own = tile.numbers.size();
    EXPECT_LT(numbers.size(), 1.2 * double(options.most));
    ASSERT_TRUE(std::equal(tile.numbers.begin(), tile.numbers.end(), numbers.begin()));
    Eigen::Array3d low = positionOf(numbers[0]), high = low;
    for (std::size_t k = 0; k < own; ++k) {
      ++owners[numbers[k]];
      if (!positionOf(numbers[k]).allFinite())
        continue;
      low = low.min(positionOf(numbers[k]).array());
      high = high.max(positionOf(numbers[k]).array());
    }
    const std::set<std::size_t> seen(numbers.begin(), numbers.end());
    EXPECT_EQ(seen.size(), numbers.size());
    for (std::size_t i = 0; i < kPoints; ++i) {
      const Eigen::Array3d position = positionOf(i);
      if ((position > low - 0.499).all() && (position < high + 0.499).all()) {
        ASSERT_EQ(seen.count(i), 1u) << i;
      }
    }
  }
  EXPECT_EQ(std::count(owners.begin(), owners.end(), 1), std::ptrdiff_t(kPoints));
}

TEST_F(CloudTilesTest, DoNotCutVoxels)
{
  TileOptions options;
  options.voxel_size = 0.7;
  options.most = 3000;
  const auto divided = divide(options);
  const CloudTiles& tiles = *divided;
  EXPECT_GT(tiles.size(), 5u);
  std::map<std::array<int, 3>, std::set<std::size_t>> tiles_of_voxels;
  for (std::size_t t = 0; t < tiles.size(); ++t)
    for (const std::size_t number : numbersOf(tiles.read(t))) {
      const Eigen::Array3d voxel = (positionOf(number).array() / 0.7).floor();
      if (voxel.isFinite().all())
        tiles_of_voxels[{int(voxel[0]), int(voxel[1]), int(voxel[2])}].insert(t);
    }
  for (const auto& [voxel, found] : tiles_of_voxels)
    EXPECT_EQ(found.size(), 1u);
}

TEST_F(CloudTilesTest, KnowTheWholeCloud)
{
  PcdReader reader(path);
  CloudSurvey survey = surveyCloud(reader, nullptr, step);
  measureSpacing(reader, step, survey);
  EXPECT_EQ(survey.sample.points, kPoints);
  EXPECT_EQ(survey.without_place, 30u);
  EXPECT_EQ(survey.largest_label, 3u);
  EXPECT_TRUE(survey.has_labels);
  EXPECT_FALSE(survey.has_colour);
  EXPECT_EQ(survey.class_sums.head(3), Eigen::Vector3d::Constant(9990.0));
  EXPECT_LT(survey.sample.low.maxCoeff(), 0.01f);
  // Poisson: the fourth neighbour's mean distance at 250 points a cubic metre.
  EXPECT_NEAR(survey.sample.spacing, 0.155, 0.02);
  EXPECT_EQ(steps, 3);
}

TEST_F(CloudTilesTest, AreWrittenInTheOrderOfTheirNumbers)
{
  CloudRowWriter writer(folder.path("out.pcd"), kPoints);
  std::vector<std::uint64_t> order(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i)
    order[i] = i;
  std::mt19937 random(1);
  std::shuffle(order.begin(), order.end(), random);
  for (std::size_t first = 0; first < kPoints; first += 1000) {
    PcdTable part = table;
    part.width = 1000;
    part.data.clear();
    std::vector<std::uint64_t> numbers;
    for (std::size_t k = first; k < first + 1000; ++k) {
      const auto row = table.data.begin() + std::ptrdiff_t(order[k] * table.point_step);
      part.data.insert(part.data.end(), row, row + table.point_step);
      numbers.push_back(order[k]);
    }
    writer.append(part, numbers);
  }
  PcdTable other = table;
  other.removeColumns("label");
  EXPECT_THROW(writer.append(other, {0}), BadInputException);
  writer.write(table);
  EXPECT_TRUE(readCloudTable(folder.path("out.pcd")).data == table.data);
}
