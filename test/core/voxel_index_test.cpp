// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/voxel_index.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <unordered_set>

using namespace pcl_semantic;

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
