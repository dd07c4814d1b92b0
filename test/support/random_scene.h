// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <opencv2/core/mat.hpp>

#include <map>
#include <random>
#include <vector>

namespace pcl_semantic {

/** \brief An empty scene with voxels of 0.25 m aligned with the world grid, relative to
 * a far origin. */
inline VoxelScene
emptyScene()
{
  VoxelScene scene;
  scene.origin = {1000.0, -2000.0, 0.0};
  scene.grid = {0.25, -scene.origin};
  scene.voxels.voxel_size = scene.grid.size;
  scene.voxels.origin = scene.grid.corner;
  scene.has_colour = scene.has_labels = true;
  return scene;
}

inline void
addVoxel(VoxelScene& scene, const VoxelIndex& voxel, Label label)
{
  pcl::PointXYZRGBL point;
  point.getVector3fMap() = centreOf(scene.grid, voxel).cast<float>();
  point.label = label;
  scene.voxels.cloud->push_back(point);
  scene.voxels.indices.push_back(voxel);
}

/** \brief A third of the voxels on both sides of the origin, with labels 0 to 3, and as
 * many free voxels. */
inline VoxelScene
randomScene(unsigned seed)
{
  std::mt19937 random(seed);
  VoxelScene scene = emptyScene();
  for (int z = -5; z < 7; ++z)
    for (int y = -4; y < 8; ++y)
      for (int x = -9; x < 3; ++x)
        if (const unsigned dice = random() % 3; dice == 0)
          addVoxel(scene, {x, y, z}, Label(random() % 4));
        else if (dice == 1)
          scene.free.emplace_back(x, y, z);
  scene.knows_free = true;
  return scene;
}

/** \brief Few colours, so that neighbours often share one. */
inline std::vector<cv::Vec3b>
randomColours(const VoxelScene& scene, unsigned seed)
{
  std::mt19937 random(seed);
  std::vector<cv::Vec3b> colours;
  for (std::size_t i = 0; i < scene.voxels.size(); ++i)
    colours.push_back(random() % 2 ? cv::Vec3b(1, 2, 3) : cv::Vec3b(200, 100, 255));
  return colours;
}

inline std::map<VoxelIndex, std::size_t, VoxelIndexLess>
rowsOf(const VoxelScene& scene)
{
  std::map<VoxelIndex, std::size_t, VoxelIndexLess> rows;
  for (std::size_t i = 0; i < scene.voxels.size(); ++i)
    rows[scene.voxels.indices[i]] = i;
  return rows;
}

} // namespace pcl_semantic
