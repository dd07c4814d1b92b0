/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "tile_sweep.h"

#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/map/ray_caster.h>
#include <pcl_semantic/map/ray_traversal.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pcl_semantic {

namespace {

QuantizedPoint
quantize(const Eigen::Vector3d& point, double voxel_size)
{
  const double scale = double(1 << kQuantizationBits) / voxel_size;
  return (point * scale).array().floor().cast<std::int64_t>();
}

// Further away nothing can be meant; it also keeps the arithmetic exact [m].
constexpr float largest_reach = 1e6f;

// The largest coordinate of a point; NaN if one is.
float
reachOf(const Eigen::Vector3f& point)
{
  return point.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
}

bool
isSky(const Scan& scan, std::size_t i, const RayCaster::Settings& settings)
{
  return scan.distributions &&
         settings.is_sky[scan.distributions->mapLabel(Eigen::Index(i))];
}

// The ray from one point to another, as the sweep wants it.
DirectedRay
directedRay(const QuantizedPoint& start, const QuantizedPoint& end, std::size_t point)
{
  const QuantizedPoint delta = end - start;
  int along = 0;
  delta.array().abs().maxCoeff(&along);
  const int face = 2 * along + (delta[along] < 0);
  const FaceAxes axes(face);
  const VoxelIndex cells = voxelOf(end) - voxelOf(start);
  const double length = std::max(1.0, double(std::llabs(delta[along])));
  DirectedRay ray;
  ray.row_slope = float(double(delta[axes.row]) / length);
  ray.column_slope = float(double(delta[axes.column]) / length);
  ray.end_slab = std::abs(cells[along]);
  ray.end_row = cells[axes.row];
  ray.end_column = cells[axes.column];
  ray.point = std::uint32_t(point);
  setTile(face, ray);
  return ray;
}

constexpr std::size_t tiles = 6 * kTilesAFace;

// Rays in the order of their tiles; where each tile begins.
std::vector<DirectedRay>
sortByTile(const std::vector<DirectedRay>& rays, std::vector<std::size_t>& first)
{
  first.assign(tiles + 1, 0);
  for (const DirectedRay& ray : rays)
    ++first[ray.tile + 1u];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::size_t> next = first;
  std::vector<DirectedRay> sorted(rays.size());
  for (const DirectedRay& ray : rays)
    sorted[next[ray.tile]++] = ray;
  return sorted;
}

void
crossVoxels(const QuantizedPoint& start, const std::vector<QuantizedPoint>& ends,
            const std::vector<DirectedRay>& rays, CrossedVoxels& crossed)
{
  std::vector<std::size_t> first;
  const std::vector<DirectedRay> sorted = sortByTile(rays, first);
  ParallelGuard guard;
#pragma omp parallel
  guard.run([&] {
    TileSweep sweep(start, ends, crossed);
#pragma omp for schedule(dynamic, 1)
    for (std::size_t tile = 0; tile < tiles; ++tile)
      if (first[tile + 1] > first[tile])
        guard.run([&] {
          sweep.run(int(tile) / kTilesAFace, sorted.data() + first[tile],
                    first[tile + 1] - first[tile]);
        });
  });
  guard.rethrow();
}

} // namespace

ScanCounts
RayCaster::cast(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                const Grid& grid, const Settings& settings)
{
  crossed_.begin(grid);
  hits_.clear();
  const QuantizedPoint start =
      quantize(T_world_sensor.translation(), settings.voxel_size);
  const float range = float(settings.max_range);
  std::vector<QuantizedPoint> ends(scan.points.size());
  std::vector<DirectedRay> rays;
  std::size_t invalid = 0, sky = 0;
  ParallelGuard guard; // hits are gathered, which takes memory
#pragma omp parallel reduction(+ : invalid, sky)
  {
    std::vector<RayHit> own_hits;
    std::vector<DirectedRay> own_rays;
#pragma omp for schedule(static) nowait
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const float reach = reachOf(scan.points[i]);
      if (!(reach < largest_reach)) { // or NaN
        ++invalid;
        continue;
      }
      if (isSky(scan, i, settings)) {
        ++sky;
        continue;
      }
      const bool in_range = reach <= range;
      const double share = in_range ? 1.0 : double(range / reach);
      ends[i] = quantize(T_world_sensor * (share * scan.points[i].cast<double>()),
                         settings.voxel_size);
      const VoxelIndex voxel = voxelOf(ends[i]);
      const VoxelIndex block = blockOf(voxel);
      guard.run([&] {
        own_rays.push_back(directedRay(start, ends[i], i));
        if (in_range && crossed_.contains(block))
          own_hits.emplace_back(crossed_.slotOf(block), voxelInBlock(voxel), i);
      });
    }
#pragma omp critical
    guard.run([&] {
      hits_.insert(hits_.end(), own_hits.begin(), own_hits.end());
      rays.insert(rays.end(), own_rays.begin(), own_rays.end());
    });
  }
  guard.rethrow();
  std::sort(hits_.begin(), hits_.end());
  crossVoxels(start, ends, rays, crossed_);
  return {scan.points.size(), rays.size(), invalid, sky, 0};
}

} // namespace pcl_semantic
