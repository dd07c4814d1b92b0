// SPDX-License-Identifier: BSD-3-Clause
#include "io/moved_archive.h"
#include "support/archives.h"
#include "support/thrown_message.h"

#include <gtest/gtest.h>

namespace pcl_semantic {

namespace {

constexpr int classes = 3;
constexpr double voxel_size = 0.25; // of makeArchiveHeader()

// A cube of 4 x 4 x 4 random blocks with gaps.
Blocks
cubeOfBlocks()
{
  Blocks blocks;
  for (int z = -2; z < 2; ++z)
    for (int y = -2; y < 2; ++y)
      for (int x = 3; x < 7; ++x)
        if ((x + y + z) % 5 != 0)
          blocks[VoxelIndex(x, y, z)] =
              makeRandomBlock(200, classes, unsigned(x + 10 * y + 100 * z + 1000));
  return blocks;
}

Blocks
movedBlocks(const std::string& path, const Eigen::Isometry3d& motion)
{
  const MovedArchive moved(path, motion);
  const std::vector<VoxelIndex> indices = moved.indices();
  const auto read = moved.read(indices);
  Blocks blocks;
  for (std::size_t i = 0; i < indices.size(); ++i)
    if (read[i])
      blocks[indices[i]] = *read[i];
  return blocks;
}

class MovedMap : public testing::Test {
protected:
  void
  SetUp() override
  {
    createWith(path_, blocks_);
  }

  const VoxelBlock*
  find(const VoxelIndex& voxel) const
  {
    const auto found = blocks_.find(blockOf(voxel));
    return found == blocks_.end() ? nullptr : &found->second;
  }

  TemporaryFolder folder_;
  const std::string path_ = folder_.path("a.map");
  const Blocks blocks_ = cubeOfBlocks();
};

} // namespace

TEST_F(MovedMap, KeepsEveryBitByWholeBlocks)
{
  for (const VoxelIndex& blocks : {VoxelIndex(0, 0, 0), VoxelIndex(5, -3, 1)}) {
    const Eigen::Isometry3d motion(
        Eigen::Translation3d(blocks.cast<double>() * kBlockEdge * voxel_size));
    const Blocks moved = movedBlocks(path_, motion);
    ASSERT_EQ(moved.size(), blocks_.size());
    for (const auto& [index, block] : moved)
      EXPECT_TRUE(areSameBlocks(block, blocks_.at(index - blocks), classes));
  }
}

// Computes each voxel from the source of its centre.
TEST_F(MovedMap, IsWhatAVoxelsCentreComesFrom)
{
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d(0.2, -0.1, 1.0).normalized()));
  motion.pretranslate(Eigen::Vector3d(1.7, -20.3, 0.6));
  const Blocks moved = movedBlocks(path_, motion);
  std::size_t known = 0, hit = 0, at_walls = 0;
  for (const auto& [index, block] : moved)
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const VoxelIndex to = voxelAt(index, offset);
      const Eigen::Vector3d centre = voxel_size * (to.cast<double>().array() + 0.5);
      const VoxelIndex from =
          (motion.inverse() * centre / voxel_size).array().floor().cast<int>();
      const VoxelBlock* const source = find(from);
      const auto at = std::size_t(voxelInBlock(from));
      ASSERT_EQ(block.log_odds[std::size_t(offset)],
                source ? source->log_odds[at] : kUnknown);
      known += block.log_odds[std::size_t(offset)] != kUnknown;
      const int new_record = block.recordAt(offset);
      const int old_record = source ? source->recordAt(int(at)) : -1;
      ASSERT_EQ(new_record < 0, old_record < 0);
      if (new_record < 0)
        continue;
      ++hit;
      const VoxelRecord& record = block.records[std::size_t(new_record)];
      const VoxelRecord& old = source->records[std::size_t(old_record)];
      EXPECT_EQ(record.colour_sum, old.colour_sum);
      EXPECT_EQ(record.observations, old.observations);
      for (int k = 0; k < classes; ++k) {
        EXPECT_EQ(block.measured[std::size_t(new_record * classes + k)],
                  source->measured[std::size_t(old_record * classes + k)]);
        EXPECT_EQ(block.refined[std::size_t(new_record * classes + k)],
                  source->refined[std::size_t(old_record * classes + k)]);
      }
      const Eigen::Vector3d was(old.position[0], old.position[1], old.position[2]);
      const Eigen::Vector3d is(record.position[0], record.position[1],
                               record.position[2]);
      const Eigen::Vector3d expected =
          motion * (voxel_size * (from.cast<double>() + was / 65536.0)) / voxel_size -
          to.cast<double>();
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(is[axis] / 65536.0, std::clamp(expected[axis], 0.0, 1.0), 4e-5);
        at_walls += expected[axis] < 0.0 || expected[axis] > 1.0;
      }
    }
  const auto all = double(blocks_.size() * kBlockVoxels);
  EXPECT_NEAR(double(known) / all, 0.75, 0.01) << "makeRandomBlock() knows so many";
  EXPECT_NEAR(double(hit) / all, 200.0 / 512.0, 0.01);
  EXPECT_GT(at_walls, 100u);
}

TEST_F(MovedMap, MovesNoFartherThanIndicesReach)
{
  const Eigen::Isometry3d motion(Eigen::Translation3d(0.0, 1e9, 0.0));
  expectBadInput("expected at most 2.5e+08 voxels",
                 [&] { MovedArchive(path_, motion); });
}

} // namespace pcl_semantic
