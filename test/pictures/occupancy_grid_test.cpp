// SPDX-License-Identifier: BSD-3-Clause

// Grids as map_server would read them, compared with the voxels column by column.

#include "support/random_scene.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pictures/occupancy_grid.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>

using namespace pcl_semantic;

namespace {

constexpr Label kRoad = 1, kGrass = 2, kHouse = 3;

/** \brief ROS' interpretation of the two files: -1 unknown, 0 free, 100 occupied. */
struct ReadGrid {
  int width = 0, height = 0;
  double resolution = 0.0, x = 0.0, y = 0.0;
  std::vector<int> values; // rows from below, as in a nav_msgs/OccupancyGrid

  // At a place in the world; nothing outside.
  std::optional<int>
  at(double world_x, double world_y) const
  {
    const double column = std::floor((world_x - x) / resolution);
    const double row = std::floor((world_y - y) / resolution);
    if (!(column >= 0 && column < width && row >= 0 && row < height))
      return {};
    return values[std::size_t(row) * std::size_t(width) + std::size_t(column)];
  }
};

std::map<std::string, std::string>
readDescription(const std::string& path)
{
  std::map<std::string, std::string> entries;
  std::istringstream text(bytesOf(path));
  for (std::string line; std::getline(text, line);) {
    const std::size_t colon = line.find(": ");
    EXPECT_NE(colon, std::string::npos) << line;
    entries[line.substr(0, colon)] = line.substr(colon + 2);
  }
  return entries;
}

ReadGrid
readGrid(const std::string& description)
{
  auto entries = readDescription(description);
  EXPECT_EQ(entries.size(), 6u);
  EXPECT_EQ(entries["negate"], "0");
  ReadGrid grid;
  double yaw = 1.0;
  grid.resolution = std::stod(entries["resolution"]);
  EXPECT_EQ(
      std::sscanf(entries["origin"].c_str(), "[%lf, %lf, %lf]", &grid.x, &grid.y, &yaw),
      3);
  EXPECT_EQ(yaw, 0.0);
  const double occupied = std::stod(entries["occupied_thresh"]),
               free = std::stod(entries["free_thresh"]);
  const std::filesystem::path folder = std::filesystem::path(description).parent_path();
  const std::string image = bytesOf((folder / entries["image"]).string());
  int largest = 0, header = 0;
  EXPECT_EQ(std::sscanf(image.c_str(), "P5\n%d %d\n%d%n", &grid.width, &grid.height,
                        &largest, &header),
            3);
  EXPECT_EQ(largest, 255);
  const auto width = std::size_t(grid.width), height = std::size_t(grid.height);
  const std::size_t begin = std::size_t(header) + 1; // one line break
  EXPECT_EQ(image.size(), begin + width * height);
  for (std::size_t row = height; row-- > 0;)
    for (std::size_t column = 0; column < width; ++column) {
      const auto shade = static_cast<std::uint8_t>(image[begin + row * width + column]);
      const double p = (255.0 - shade) / 255.0;
      grid.values.push_back(p > occupied ? 100 : p < free ? 0 : -1);
    }
  return grid;
}

ReadGrid
writtenGrid(const OccupancyGrid& grid)
{
  const TemporaryFolder folder;
  writeOccupancyGrid(folder.path("a map.pgm"), grid);
  EXPECT_EQ(folder.entries(), 2u);
  return readGrid(folder.path("a map.yaml"));
}

OccupancyGridParameters
parameters()
{
  OccupancyGridParameters parameters;
  parameters.ground = {kRoad, kGrass};
  parameters.min_height = 0.5;
  parameters.max_height = 1.5;
  parameters.reach = 1.0;
  return parameters;
}

// Value of a grid for the column of a voxel.
std::optional<int>
valueAt(const ReadGrid& grid, int x, int y)
{
  return grid.at((x + 0.5) * 0.25, (y + 0.5) * 0.25);
}

/** \brief Ground everywhere, of random height and class, with things above it. */
class RandomGround {
public:
  static constexpr int kWidth = 21, kHeight = 17, kLeft = -8, kBottom = 3;

  explicit RandomGround(unsigned seed) : scene(emptyScene())
  {
    std::mt19937 random(seed);
    scene.knows_free = true;
    for (int y = kBottom; y < kBottom + kHeight; ++y)
      for (int x = kLeft; x < kLeft + kWidth; ++x) {
        // Now and then a hole or a roof that is called ground.
        const int top = random() % 10 == 0 ? int(random() % 12) - 6 : int(random() % 2);
        const Label label = random() % 3 ? kRoad : kGrass;
        top_[{x, y}] = top;
        addVoxel(scene, {x, y, top}, label);
        addVoxel(scene, {x, y, top - 1}, label == kRoad ? kGrass : kRoad);
        addVoxel(scene, {x, y, top + 20}, kRoad); // of a bridge
        for (int z = top + 1; z < top + 12; ++z)
          if (const unsigned dice = random() % 24; dice == 0)
            addVoxel(scene, {x, y, z}, kHouse);
          else if (dice < 3)
            scene.free.emplace_back(x, y, z);
      }
  }

  /** \brief Median of the tops of 5 x 5 columns; beyond the border the outermost column
   * is repeated. */
  double
  ground(int x, int y) const
  {
    std::vector<int> tops;
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx)
        tops.push_back(top_.at({std::clamp(x + dx, kLeft, kLeft + kWidth - 1),
                                std::clamp(y + dy, kBottom, kBottom + kHeight - 1)}));
    std::nth_element(tops.begin(), tops.begin() + 12, tops.end());
    return (tops[12] + 1) * 0.25;
  }

  bool
  hasOneBetween(const std::vector<VoxelIndex>& voxels, int x, int y) const
  {
    return std::any_of(voxels.begin(), voxels.end(), [&](const VoxelIndex& voxel) {
      const double above = (voxel.z() + 0.5) * 0.25 - ground(x, y);
      return voxel.x() == x && voxel.y() == y && above >= 0.5 && above < 1.5;
    });
  }

  bool
  hasOwnGround(int x, int y) const
  {
    return std::abs((top_.at({x, y}) + 1) * 0.25 - ground(x, y)) <= 0.5;
  }

  VoxelScene scene;

private:
  std::map<std::pair<int, int>, int> top_;
};

template <typename Expected>
void
expectGrid(const ReadGrid& grid, Expected&& expected)
{
  using Ground = RandomGround;
  EXPECT_EQ(grid.width, Ground::kWidth);
  EXPECT_EQ(grid.height, Ground::kHeight);
  EXPECT_EQ(grid.resolution, 0.25);
  std::map<int, int> counts;
  for (int y = Ground::kBottom; y < Ground::kBottom + Ground::kHeight; ++y)
    for (int x = Ground::kLeft; x < Ground::kLeft + Ground::kWidth; ++x) {
      ASSERT_EQ(valueAt(grid, x, y), expected(x, y)) << x << " " << y;
      ++counts[expected(x, y)];
    }
  EXPECT_EQ(counts.size(), 3u); // all three values occur
  EXPECT_FALSE(valueAt(grid, Ground::kLeft - 1, Ground::kBottom));
}

} // namespace

TEST(OccupancyGrid, EqualsAPlainLoop)
{
  RandomGround ground(1);
  for (const bool knows_free : {true, false}) {
    ground.scene.knows_free = knows_free;
    const ReadGrid grid = writtenGrid(occupancyGrid(ground.scene, parameters()));
    expectGrid(grid, [&](int x, int y) {
      if (ground.hasOneBetween(ground.scene.voxels.indices, x, y))
        return 100;
      const bool is_free = knows_free ? ground.hasOneBetween(ground.scene.free, x, y)
                                      : ground.hasOwnGround(x, y);
      return is_free ? 0 : -1;
    });
  }
}

TEST(OccupancyGrid, TakesTheGroundOfTheNearestColumn)
{
  // Road at 0 m to the left, at 5 m to the right, and between them nothing but posts.
  VoxelScene scene = emptyScene();
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 10; ++x) {
      addVoxel(scene, {x, y, -1}, kRoad);
      addVoxel(scene, {x + 20, y, 19}, kRoad);
    }
    for (int x = 10; x < 20; ++x)
      addVoxel(scene, {x, y, y % 2 ? 3 : 23}, kHouse);
  }
  OccupancyGridParameters wanted = parameters();
  wanted.reach = 100.0;
  const ReadGrid everywhere = writtenGrid(occupancyGrid(scene, wanted));
  wanted.reach = 0.8; // three columns of 0.25 m
  const ReadGrid near = writtenGrid(occupancyGrid(scene, wanted));
  for (int y = 3; y < 27; ++y)
    for (int x = 0; x < 30; ++x) {
      if (x < 10 || x >= 20) {
        EXPECT_EQ(valueAt(everywhere, x, y), 0);
        continue;
      }
      const int expected = (y % 2 == 1) == (x < 15) ? 100 : -1;
      EXPECT_EQ(valueAt(everywhere, x, y), expected) << x << " " << y;
      EXPECT_EQ(valueAt(near, x, y), x < 13 || x >= 17 ? expected : -1)
          << x << " " << y;
    }
}

TEST(OccupancyGrid, OfOneVoxel)
{
  VoxelScene scene = emptyScene();
  addVoxel(scene, {-3, 5, 7}, kRoad);
  const ReadGrid grid = writtenGrid(occupancyGrid(scene, parameters()));
  EXPECT_EQ(grid.values, std::vector<int>{0});
  EXPECT_EQ(valueAt(grid, -3, 5), 0);
  EXPECT_EQ(grid.x, -0.75);
  EXPECT_EQ(grid.y, 1.25);
}

TEST(OccupancyGrid, RefusesWhatMakesNoPlan)
{
  VoxelScene scene = emptyScene();
  addVoxel(scene, {0, 0, 0}, kHouse);
  const auto badMap = [&] {
    return thrownMessage<BadInputException>(
        [&] { occupancyGrid(scene, parameters()); });
  };
  EXPECT_TRUE(holds(badMap(), "no voxel of the classes of the ground"));
  addVoxel(scene, {100000, 100000, 0}, kRoad);
  EXPECT_TRUE(holds(badMap(), "100001 x 100001 columns"));
  const auto message = [&](double lowest, double highest, double reach) {
    OccupancyGridParameters bad = parameters();
    bad.min_height = lowest;
    bad.max_height = highest;
    bad.reach = reach;
    return thrownMessage<InvalidParameterException>([&] { occupancyGrid(scene, bad); });
  };
  EXPECT_TRUE(holds(message(-1, 1, 1), "the heights are -1 and 1 m"));
  EXPECT_TRUE(holds(message(1, 1, 1), "the heights are 1 and 1 m"));
  EXPECT_TRUE(holds(message(0, INFINITY, 1), "the heights are 0 and inf m"));
  EXPECT_TRUE(holds(message(0, 1, NAN), "the reach of the ground is nan m"));
}

TEST(OccupancyGrid, LeavesNothingWhereItCannotWrite)
{
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("a.yaml"));
  VoxelScene scene = emptyScene();
  addVoxel(scene, {0, 0, 0}, kRoad);
  expectRefusal<OutputException>("a.yaml: cannot be written", [&] {
    writeOccupancyGrid(folder.path("a.pgm"), occupancyGrid(scene, parameters()));
  });
  EXPECT_EQ(folder.entries(), 1u);
}
