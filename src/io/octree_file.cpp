// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/octree_file.h>

#include "core/fail.h"

#include <pcl_semantic/files/atomic_file.h>

// Otherwise debug builds print a message for every written tree.
#ifndef OCTOMAP_NODEBUGOUT
#define OCTOMAP_NODEBUGOUT
#endif
#include <octomap/OcTree.h>

#include <iomanip>

namespace pcl_semantic {

namespace {

// The octree's voxel at voxel 0 of the scene.
VoxelIndex
firstVoxel(const VoxelScene& scene)
{
  const Eigen::Array3d cells = (scene.grid.corner + scene.origin) / scene.grid.size;
  if (!(cells.abs() < double(kMaxVoxelIndex)).all())
    badInput("the map is too far from the origin for an octree");
  return cells.round().cast<int>();
}

octomap::OcTreeKey
keyOf(const VoxelIndex& voxel, const VoxelIndex& first)
{
  constexpr std::int64_t half = 1 << 15; // an octree has 16 levels
  octomap::OcTreeKey key;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t cell = std::int64_t(voxel[axis]) + first[axis];
    if (cell < -half || cell >= half)
      badInput("the map reaches ", cell, " voxels from the origin, an octree holds ",
               half, " to each side");
    key[unsigned(axis)] = static_cast<octomap::key_type>(cell + half);
  }
  return key;
}

void
fill(octomap::OcTree& tree, const VoxelScene& scene)
{
  const VoxelIndex first = firstVoxel(scene);
  for (const VoxelIndex& voxel : scene.free)
    tree.setNodeValue(keyOf(voxel, first), tree.getClampingThresMinLog(), true);
  for (const VoxelIndex& voxel : scene.voxels.indices)
    tree.setNodeValue(keyOf(voxel, first), tree.getClampingThresMaxLog(), true);
  tree.updateInnerOccupancy();
  tree.prune();
}

// Header of an OctoMap file. OctoMap's own function prints messages and rounds the
// voxel size to six digits, too few for some sizes.
void
writeHeader(std::ostream& stream, const octomap::OcTree& tree)
{
  stream << "# Octomap OcTree binary file\nid " << tree.getTreeType() << "\nsize "
         << tree.size() << "\nres " << std::setprecision(15) << tree.getResolution()
         << "\ndata\n";
}

} // namespace

Eigen::Vector3d
octreeShift(const VoxelScene& scene)
{
  return firstVoxel(scene).cast<double>() * scene.grid.size -
         (scene.grid.corner + scene.origin);
}

void
writeOctree(const std::string& path, const VoxelScene& scene)
{
  AtomicFile file(path);
  octomap::OcTree tree(scene.grid.size);
  fill(tree, scene);
  writeHeader(file.stream(), tree);
  tree.writeBinaryData(file.stream());
  file.commit();
}

} // namespace pcl_semantic
