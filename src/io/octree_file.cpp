// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/octree_file.h>

#include "core/fail.h"

#include <pcl_semantic/files/atomic_file.h>

// Else a build with assertions tells standard error of every tree that it writes.
#ifndef OCTOMAP_NODEBUGOUT
#define OCTOMAP_NODEBUGOUT
#endif
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <iomanip>

namespace pcl_semantic {

namespace {

// The library joins voxels whatever their colours, and mixes these.
class ExactColourTree : public octomap::ColorOcTree {
public:
  using octomap::ColorOcTree::ColorOcTree;

  bool
  isNodeCollapsible(const octomap::ColorOcTreeNode* node) const override
  {
    if (!octomap::ColorOcTree::isNodeCollapsible(node))
      return false;
    for (unsigned child = 1; child < 8; ++child)
      if (getNodeChild(node, child)->getColor() != getNodeChild(node, 0)->getColor())
        return false;
    return true;
  }
};

// The voxel of an octree in which cube 0 of the scene lies.
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

template <typename Tree, typename Paint>
void
fill(Tree& tree, const VoxelScene& scene, Paint&& paint)
{
  const VoxelIndex first = firstVoxel(scene);
  for (const VoxelIndex& voxel : scene.free)
    tree.setNodeValue(keyOf(voxel, first), tree.getClampingThresMinLog(), true);
  for (std::size_t i = 0; i < scene.voxels.size(); ++i)
    paint(*tree.setNodeValue(keyOf(scene.voxels.indices[i], first),
                             tree.getClampingThresMaxLog(), true),
          i);
  tree.updateInnerOccupancy();
  tree.prune();
}

// What the library's own writing begins with. That talks on standard error, and gives
// the size of the voxels six digits, which are too few for some.
void
writeHeader(std::ostream& stream, const char* title,
            const octomap::AbstractOcTree& tree)
{
  stream << "# Octomap OcTree " << title << "\nid " << tree.getTreeType() << "\nsize "
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
  fill(tree, scene, [](octomap::OcTreeNode&, std::size_t) {});
  writeHeader(file.stream(), "binary file", tree);
  tree.writeBinaryData(file.stream());
  file.commit();
}

void
writeColourOctree(const std::string& path, const VoxelScene& scene,
                  const std::vector<cv::Vec3b>& colours)
{
  if (colours.size() != scene.voxels.size())
    badParameter(colours.size(), " colours for ", scene.voxels.size(), " voxels");
  AtomicFile file(path);
  ExactColourTree tree(scene.grid.size);
  fill(tree, scene, [&](octomap::ColorOcTreeNode& node, std::size_t i) {
    node.setColor(colours[i][2], colours[i][1], colours[i][0]);
  });
  writeHeader(file.stream(), "file", tree);
  tree.writeData(file.stream());
  file.commit();
}

} // namespace pcl_semantic
