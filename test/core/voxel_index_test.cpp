// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/voxel_index.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <unordered_set>

using namespace pcl_semantic;

TEST(VoxelIndex, FloorDivideRoundsTowardsMinusInfinity)
{
  static_assert(floorDivide(-1, 8) == -1);
  for (const int divisor : {1, 2, 3, 7, 8, 1000})
    for (int value = -2100; value <= 2100; ++value)
      ASSERT_EQ(floorDivide(value, divisor),
                static_cast<int>(std::floor(double(value) / divisor)))
          << value << " / " << divisor;
}

TEST(VoxelIndex, FloorDivideWorksAtTheEndsOfTheRange)
{
  constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t largest = std::numeric_limits<std::int32_t>::max();
  for (const std::int32_t divisor : {1, 2, 8, largest})
    for (const std::int32_t value :
         {lowest, lowest + 1, -kMaxVoxelIndex, kMaxVoxelIndex, largest - 1, largest})
      EXPECT_EQ(floorDivide(value, divisor),
                static_cast<std::int32_t>(std::floor(double(value) / divisor)))
          << value << " / " << divisor;
}

TEST(VoxelIndex, TheOrderIsZThenYThenX)
{
  const VoxelIndexLess less;
  EXPECT_TRUE(less({9, 9, 0}, {0, 0, 1}));
  EXPECT_TRUE(less({9, 0, 5}, {0, 1, 5}));
  EXPECT_TRUE(less({-1, 2, 5}, {0, 2, 5}));
  EXPECT_FALSE(less({3, 2, 1}, {3, 2, 1}));
}

TEST(VoxelIndex, TheCentreIsHalfAVoxelBeyondTheIndex)
{
  EXPECT_EQ(centreOf(VoxelIndex(0, -1, 2), 0.5), Eigen::Vector3d(0.25, -0.25, 1.25));
  EXPECT_EQ(centreOf(Eigen::Vector3d(1e12, 0.0, -1e12), 1.0),
            Eigen::Vector3d(1e12 + 0.5, 0.5, -1e12 + 0.5)); // beyond VoxelIndex
}

TEST(VoxelIndex, ANeighbourhoodHasNoEqualHashes)
{
  std::unordered_set<std::size_t> hashes;
  for (int z = -20; z < 20; ++z)
    for (int y = -20; y < 20; ++y)
      for (int x = -20; x < 20; ++x)
        hashes.insert(VoxelIndexHash()({x, y, z}));
  EXPECT_EQ(hashes.size(), 64000u);
}
