// SPDX-License-Identifier: BSD-3-Clause
#include "map/scrolling_voxel_grid.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <stdexcept>
#include <tuple>

namespace {

using namespace pcl_semantic;
using Key = std::tuple<int, int, int>;

Key
keyOf(const VoxelIndex& index)
{
  return {index.x(), index.y(), index.z()};
}

// The grid with a store behind it, compared with an unbounded map.
class Model {
public:
  explicit Model(const Eigen::Vector3i& size) : grid_(size) {}

  void
  scrollTo(const VoxelIndex& origin)
  {
    grid_.scrollTo(
        origin,
        [&](const VoxelIndex& index, int& block) {
          EXPECT_TRUE(
              store_.emplace(keyOf(index), std::make_unique<int>(block)).second);
        },
        [&](const VoxelIndex& index) {
          std::unique_ptr<int> block;
          if (const auto found = store_.find(keyOf(index)); found != store_.end()) {
            block = std::move(found->second);
            store_.erase(found);
          }
          return block;
        });
  }

  void
  write(const VoxelIndex& index, int value)
  {
    grid_.at(grid_.slotOf(index)) = std::make_unique<int>(value);
    all_[keyOf(index)] = value;
  }

  void
  compare() const
  {
    std::map<Key, int> held;
    grid_.forEach([&](const VoxelIndex& index, const int& value) {
      EXPECT_TRUE(grid_.contains(index));
      held[keyOf(index)] = value;
    });
    for (const auto& [key, value] : store_)
      EXPECT_TRUE(held.emplace(key, *value).second) << "in the window and in the store";
    EXPECT_EQ(held, all_);
  }

  const ScrollingVoxelGrid<int>&
  grid() const
  {
    return grid_;
  }

private:
  ScrollingVoxelGrid<int> grid_;
  std::map<Key, std::unique_ptr<int>> store_;
  std::map<Key, int> all_;
};

void
walk(const VoxelIndex& start)
{
  std::mt19937 random(5);
  const Eigen::Vector3i size(5, 4, 3);
  Model model(size);
  VoxelIndex origin = start;
  for (int step = 0; step < 600; ++step) {
    // Mostly small steps in all axes at once, now and then a jump beyond the window.
    const int reach = step % 40 == 39 ? 12 : 2;
    for (int axis = 0; axis < 3; ++axis)
      origin[axis] += int(random() % unsigned(2 * reach + 1)) - reach;
    model.scrollTo(origin);
    EXPECT_EQ(model.grid().origin(), origin);
    for (int i = 0; i < 6; ++i)
      model.write(
          origin + VoxelIndex(int(random() % 5), int(random() % 4), int(random() % 3)),
          step * 10 + i);
    model.compare();
  }
}

TEST(ScrollingVoxelGrid, EqualsAnUnboundedMapOverARandomWalk)
{
  walk(VoxelIndex::Zero());
}

TEST(ScrollingVoxelGrid, EqualsAnUnboundedMapFarFromTheOrigin)
{
  walk(VoxelIndex(1250000, -1250000, 30000));
}

TEST(ScrollingVoxelGrid, KnowsWhatIsInside)
{
  ScrollingVoxelGrid<int> grid(Eigen::Vector3i(2, 3, 4));
  EXPECT_FALSE(grid.contains({0, 0, 0})); // no window yet
  const auto leave = [](const VoxelIndex&, int&) {};
  int entered = 0;
  grid.scrollTo({0, 0, 0}, leave, [&](const VoxelIndex&) {
    ++entered;
    return std::unique_ptr<int>();
  });
  EXPECT_EQ(entered, 2 * 3 * 4);
  EXPECT_TRUE(grid.contains({1, 2, 3}));
  EXPECT_FALSE(grid.contains({2, 0, 0}));
  EXPECT_FALSE(grid.contains({0, 0, -1}));
  EXPECT_EQ(grid.find({5, 5, 5}), nullptr);
  EXPECT_EQ(grid.find({0, 0, 0}), nullptr);
}

TEST(ScrollingVoxelGrid, StaysWhereItIsIfTheStoreFails)
{
  ScrollingVoxelGrid<int> grid(Eigen::Vector3i(3, 3, 3));
  const auto leave = [](const VoxelIndex&, int&) {};
  const auto enter = [](const VoxelIndex& index) {
    return std::make_unique<int>(index.x() + 10 * index.y() + 100 * index.z());
  };
  grid.scrollTo({0, 0, 0}, leave, enter);
  const auto fail = [](const VoxelIndex&, int&) { throw std::runtime_error("full"); };
  EXPECT_THROW(grid.scrollTo({1, 1, 0}, fail, enter), std::runtime_error);
  const auto failLate = [](const VoxelIndex& index) -> std::unique_ptr<int> {
    if (index.y() == 3)
      throw std::runtime_error("damaged");
    return nullptr;
  };
  EXPECT_THROW(grid.scrollTo({1, 1, 0}, leave, failLate), std::runtime_error);
  EXPECT_EQ(grid.origin(), VoxelIndex(0, 0, 0));
  int blocks = 0;
  grid.forEach([&](const VoxelIndex& index, const int& value) {
    EXPECT_EQ(value, index.x() + 10 * index.y() + 100 * index.z());
    ++blocks;
  });
  EXPECT_EQ(blocks, 27);
}

TEST(ScrollingVoxelGrid, RefusesAnEmptyOrHugeWindow)
{
  EXPECT_THROW(ScrollingVoxelGrid<int>(Eigen::Vector3i(0, 1, 1)),
               InvalidParameterException);
  EXPECT_THROW(ScrollingVoxelGrid<int>(Eigen::Vector3i(1 << 20, 1 << 20, 1)),
               InvalidParameterException);
}

} // namespace
