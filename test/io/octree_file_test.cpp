// SPDX-License-Identifier: BSD-3-Clause

// What we write for OctoMap, read by it and asked for every voxel.

#include "support/random_scene.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/io/octree_file.h>

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <memory>
#include <set>

using namespace pcl_semantic;

namespace {

enum class State { unknown, free, occupied };

Eigen::Vector3d
worldCentre(const VoxelScene& scene, const VoxelIndex& voxel)
{
  return (voxel.cast<double>().array() + 0.5).matrix() * scene.grid.size;
}

State
stateIn(const octomap::OcTree& tree, const Eigen::Vector3d& point)
{
  const auto* const node = tree.search(point.x(), point.y(), point.z());
  if (!node)
    return State::unknown;
  return tree.isNodeOccupied(*node) ? State::occupied : State::free;
}

// A box around everything; voxels outside the scene are unknown.
void
expectSameStates(const octomap::OcTree& tree, const VoxelScene& scene)
{
  const auto rows = rowsOf(scene);
  const std::set<VoxelIndex, VoxelIndexLess> free(scene.free.begin(), scene.free.end());
  for (int z = -12; z < 20; ++z)
    for (int y = -12; y < 20; ++y)
      for (int x = -12; x < 20; ++x) {
        const VoxelIndex voxel(x, y, z);
        const State expected = rows.count(voxel)   ? State::occupied
                               : free.count(voxel) ? State::free
                                                   : State::unknown;
        ASSERT_EQ(stateIn(tree, worldCentre(scene, voxel)), expected)
            << voxel.transpose();
      }
}

// Whole cubes that can be joined: one occupied, one free.
void
addCubes(VoxelScene& scene)
{
  for (int z = 8; z < 16; ++z)
    for (int y = 8; y < 16; ++y)
      for (int x = 0; x < 16; ++x)
        if (x < 8)
          addVoxel(scene, {x, y, z}, 1);
        else
          scene.free.emplace_back(x, y, z);
}

// The file of a scene as the library reads it; no tree if it does not.
std::unique_ptr<octomap::OcTree>
writtenTree(const VoxelScene& scene)
{
  const TemporaryFolder folder;
  writeOctree(folder.path("a.bt"), scene);
  auto tree = std::make_unique<octomap::OcTree>(1.0);
  return tree->readBinary(folder.path("a.bt")) ? std::move(tree) : nullptr;
}

} // namespace

TEST(Octree, HoldsOccupiedAndFreeVoxels)
{
  for (const bool with_cubes : {false, true})
    for (const bool knows_free : {true, false}) { // of a cloud nothing is known free
      VoxelScene scene = randomScene(1);
      if (with_cubes)
        addCubes(scene);
      if (!knows_free)
        scene.free.clear();
      scene.knows_free = knows_free;
      const auto tree = writtenTree(scene);
      ASSERT_TRUE(tree);
      EXPECT_EQ(tree->getResolution(), scene.grid.size);
      expectSameStates(*tree, scene);
      if (with_cubes) { // as one node each
        EXPECT_LT(tree->getNumLeafNodes(), scene.voxels.size() + scene.free.size() -
                                               (knows_free ? 2 : 1) * 511 + 1);
      }
    }
}

TEST(Octree, KeepsAllDigitsOfTheVoxelSize)
{
  VoxelScene scene = emptyScene();
  scene.origin.setZero();
  scene.grid = {0.123456789012, Eigen::Vector3d::Zero()};
  addVoxel(scene, {30000, -30000, 5}, 1);
  const auto tree = writtenTree(scene);
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->getResolution(), 0.123456789012);
  EXPECT_EQ(stateIn(*tree, worldCentre(scene, {30000, -30000, 5})), State::occupied);
}

TEST(Octree, MovesWhatDoesNotBeginAtAMultiple)
{
  VoxelScene scene = emptyScene();
  EXPECT_EQ(octreeShift(scene), Eigen::Vector3d::Zero());
  scene.grid.corner += Eigen::Vector3d(0.25, 0.1, -0.1);
  EXPECT_LT((octreeShift(scene) - Eigen::Vector3d(0, -0.1, 0.1)).norm(), 1e-9);
}

TEST(Octree, RefusesWhatItCannotHold)
{
  const TemporaryFolder folder;
  for (const int far : {-32769, 32768}) {
    VoxelScene scene = emptyScene();
    addVoxel(scene, {0, far, 0}, 1);
    expectBadInput("reaches " + std::to_string(far) + " voxels",
                   [&] { writeOctree(folder.path("a.bt"), scene); });
  }
  EXPECT_EQ(folder.entries(), 0u);
  VoxelScene edge = emptyScene();
  addVoxel(edge, {-32768, 32767, 0}, 1);
  writeOctree(folder.path("a.bt"), edge);
}
