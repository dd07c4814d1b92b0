// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/cliques/cube_cliques.h>

#include "core/fail.h"

#include <pcl_semantic/core/no_return.h>
#include <pcl_semantic/core/voxel_index.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

namespace pcl_semantic {

namespace {

constexpr int kNoCube = -1;

// Points by cube; cubes are in the order of their first point.
struct Grouping {
  std::vector<int> cube_of_point; // kNoCube: not finite
  std::vector<VoxelIndex> cubes;
  std::vector<std::size_t> sizes;
};

// Double precision: single precision would misplace points far from the origin.
VoxelIndex
cubeOf(const pcl::PointXYZRGB& point, const Eigen::Vector3d& origin, double edge,
       std::size_t index)
{
  VoxelIndex cube;
  for (int axis = 0; axis < 3; ++axis) {
    const double position = double(point.data[axis]) + origin[axis];
    const double cell = position / edge;
    if (!(std::abs(cell) <= kMaxVoxelIndex))
      badInput("point ", index, " lies at ", position, " m, expected at most ",
               kMaxVoxelIndex, " cubes of ", edge, " m from the origin");
    const auto truncated = static_cast<std::int32_t>(cell); // avoids a call of
                                                            // std::floor
    cube[axis] = truncated - (truncated > cell ? 1 : 0);
  }
  return cube;
}

Grouping
groupByCube(const CliqueGenerator::Cloud& cloud, const Eigen::Vector3d& origin,
            double edge)
{
  Grouping groups;
  groups.cube_of_point.resize(cloud.size(), kNoCube);
  const PlaceTest has_place(cloud);
  std::unordered_map<VoxelIndex, int, VoxelIndexHash> numbers;
  VoxelIndex last_cube = VoxelIndex::Zero();
  int last = kNoCube; // consecutive points are often in the same cube
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!has_place(cloud[i]))
      continue;
    const VoxelIndex cube = cubeOf(cloud[i], origin, edge, i);
    if (last == kNoCube || cube != last_cube) {
      const auto [entry, is_new] =
          numbers.try_emplace(cube, static_cast<int>(groups.cubes.size()));
      if (is_new) {
        groups.cubes.push_back(cube);
        groups.sizes.push_back(0);
      }
      last = entry->second;
      last_cube = cube;
    }
    groups.cube_of_point[i] = last;
    ++groups.sizes[std::size_t(last)];
  }
  return groups;
}

} // namespace

CubeCliques::CubeCliques(double edge) : edge_(edge)
{
  if (!std::isfinite(edge) || edge <= 0.0)
    badParameter("cube cliques: edge is ", edge, " m, expected a positive number");
}

std::vector<pcl::PointIndices>
CubeCliques::generate(const Cloud& cloud)
{
  judgeSteps("CubeCliques", cloud);
  const Grouping groups = groupByCube(cloud, origin_, edge_);
  std::vector<std::size_t> order(groups.cubes.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return VoxelIndexLess()(groups.cubes[a], groups.cubes[b]);
  });
  std::vector<std::size_t> rank(order.size());
  std::vector<pcl::PointIndices> cliques(order.size());
  for (std::size_t r = 0; r < order.size(); ++r) {
    rank[order[r]] = r;
    cliques[r].indices.reserve(groups.sizes[order[r]]);
  }
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (const int cube = groups.cube_of_point[i]; cube != kNoCube)
      cliques[rank[std::size_t(cube)]].indices.push_back(static_cast<pcl::index_t>(i));
  return cliques;
}

} // namespace pcl_semantic
