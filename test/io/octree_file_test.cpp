// SPDX-License-Identifier: BSD-3-Clause

// What we write for OctoMap, read by it and asked for every voxel.

#include "support/random_scene.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/io/octree_file.h>

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
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

template <typename Tree>
State
stateIn(const Tree& tree, const Eigen::Vector3d& point)
{
  const auto* const node = tree.search(point.x(), point.y(), point.z());
  if (!node)
    return State::unknown;
  return tree.isNodeOccupied(*node) ? State::occupied : State::free;
}

// A box around everything: what is not in the scene is unknown.
template <typename Tree>
void
expectSameStates(const Tree& tree, const VoxelScene& scene)
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

std::unique_ptr<octomap::ColorOcTree>
readColourTree(const std::string& path)
{
  octomap::AbstractOcTree* const tree = octomap::AbstractOcTree::read(path);
  return std::unique_ptr<octomap::ColorOcTree>(
      dynamic_cast<octomap::ColorOcTree*>(tree));
}

} // namespace

TEST(Octree, HoldsOccupiedAndFreeVoxels)
{
  for (const bool with_cubes : {false, true}) {
    VoxelScene scene = randomScene(1);
    if (with_cubes)
      addCubes(scene);
    const auto tree = writtenTree(scene);
    ASSERT_TRUE(tree);
    EXPECT_EQ(tree->getResolution(), scene.grid.size);
    expectSameStates(*tree, scene);
    if (with_cubes) { // as two nodes
      EXPECT_LT(tree->getNumLeafNodes(),
                scene.voxels.size() + scene.free.size() - 2 * 511 + 1);
    }
  }
}

TEST(Octree, OfACloudHoldsNothingFree)
{
  VoxelScene scene = randomScene(2);
  scene.free.clear();
  scene.knows_free = false;
  const auto tree = writtenTree(scene);
  ASSERT_TRUE(tree);
  expectSameStates(*tree, scene);
}

TEST(Octree, HasColours)
{
  const TemporaryFolder folder;
  VoxelScene scene = randomScene(3);
  addCubes(scene);
  std::vector<cv::Vec3b> colours = randomColours(scene, 4);
  const auto rows = rowsOf(scene);
  for (const auto& [voxel, row] : rows)
    if (voxel.z() >= 12 && voxel.x() < 8) // half of the cube can be joined
      colours[row] = {9, 8, 7};
  writeColourOctree(folder.path("a.ot"), scene, colours);
  const auto tree = readColourTree(folder.path("a.ot"));
  ASSERT_TRUE(tree);
  expectSameStates(*tree, scene);
  for (const auto& [voxel, row] : rows) {
    const Eigen::Vector3d point = worldCentre(scene, voxel);
    const auto colour = tree->search(point.x(), point.y(), point.z())->getColor();
    ASSERT_EQ(cv::Vec3b(colour.b, colour.g, colour.r), colours[row])
        << voxel.transpose();
  }
  // The free cube is one node, the half of the other at most 4 of 4 x 4 x 4 voxels.
  EXPECT_LT(tree->getNumLeafNodes(),
            scene.voxels.size() + scene.free.size() - 511 - 4 * 63 + 1);
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
    EXPECT_TRUE(holds(thrownMessage<BadInputException>(
                          [&] { writeOctree(folder.path("a.bt"), scene); }),
                      "reaches " + std::to_string(far) + " voxels"));
  }
  const VoxelScene scene = randomScene(5);
  EXPECT_TRUE(holds(thrownMessage<InvalidParameterException>(
                        [&] { writeColourOctree(folder.path("a.ot"), scene, {}); }),
                    "0 colours for"));
  EXPECT_EQ(folder.entries(), 0u);
  VoxelScene edge = emptyScene();
  addVoxel(edge, {-32768, 32767, 0}, 1);
  writeOctree(folder.path("a.bt"), edge);
}
