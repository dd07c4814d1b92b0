// SPDX-License-Identifier: BSD-3-Clause
#include "ray_caster.h"
#include "core/parallel_guard.h"
#include "free_space.h"
#include "kernels/ray_directions.h"
#include "ray_traversal.h"
#include "tile_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace pcl_semantic {

namespace {

// Largest plausible distance [m]. Within this limit the arithmetic is exact.
constexpr float max_reach = 1e6f;

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

bool
hasDeviation(const Scan& scan, std::size_t i)
{
  return !scan.deviations ||
         ((*scan.deviations)[i] >= 0.0f && (*scan.deviations)[i] < max_reach);
}

// The fraction of a ray up to two deviations before its end point.
double
sureFraction(const Scan& scan, std::size_t i)
{
  if (!scan.deviations)
    return 1.0;
  const double length = double(scan.points[i].norm());
  const double uncertain = 2.0 * double((*scan.deviations)[i]);
  return length > uncertain ? 1.0 - uncertain / length : 0.0;
}

kernels::RayStart
rayStart(const Eigen::Isometry3d& T_world_sensor, const QuantizedPoint& quantized,
         double voxel_size)
{
  kernels::RayStart start;
  for (int axis = 0; axis < 3; ++axis) {
    for (int column = 0; column < 4; ++column)
      start.pose[axis][column] = T_world_sensor(axis, column);
    start.start[axis] = double(quantized[axis]);
    start.in_voxel[axis] =
        std::int32_t(quantized[axis] & ((1 << kQuantizationBits) - 1));
  }
  start.scale = double(1 << kQuantizationBits) / voxel_size;
  return start;
}

std::array<std::uint16_t, 3>
positionInVoxel(const QuantizedPoint& point)
{
  constexpr std::int64_t mask = (1 << kQuantizationBits) - 1;
  return {std::uint16_t(point.x() & mask), std::uint16_t(point.y() & mask),
          std::uint16_t(point.z() & mask)};
}

void
setRay(const kernels::RayBatch& batch, std::size_t k, DirectedRay& ray)
{
  ray.row_slope = batch.row_slope[k];
  ray.column_slope = batch.column_slope[k];
  ray.end_slab = batch.end_slab[k];
  ray.end_row = batch.end_row[k];
  ray.end_column = batch.end_column[k];
  ray.point = batch.point[k];
  ray.tile = std::uint16_t(batch.tile[k]);
  ray.leaf = std::uint16_t(batch.leaf[k]);
}

// Marks a point that casts no ray.
constexpr std::int32_t no_ray = std::numeric_limits<std::int32_t>::min();

// Points per task of a thread.
constexpr std::size_t part_size = 1 << 14;

constexpr std::size_t tiles = 6 * kTilesAFace;

} // namespace

// Hits are found first, because free-space clearing depends on neighbouring hits.
void
RayCaster::findHits(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                    const Settings& settings, std::size_t begin, std::size_t end,
                    Part& part)
{
  const float range = float(settings.max_range);
  for (std::size_t i = begin; i < end; ++i) {
    const Eigen::Vector3f point = scan.points[i];
    const float reach = reachOf(point);
    ends_[i].x() = no_ray;
    if (!(reach > 0.0f && reach < max_reach) || !hasDeviation(scan, i)) { // NaN too
      ++part.invalid;
      continue;
    }
    if (isSky(scan, i, settings)) {
      ++part.sky;
      continue;
    }
    ends_[i].setZero();
    if (reach > range)
      continue;
    const QuantizedPoint hit =
        quantize(T_world_sensor * point.cast<double>(), settings.voxel_size);
    ends_[i] = voxelOf(hit);
    if (crossed_.add(ends_[i]))
      part.hits.push_back({std::uint32_t(crossed_.slotOf(blockOf(ends_[i]))),
                           {std::uint32_t(i), std::uint16_t(voxelInBlock(ends_[i])),
                            positionInVoxel(hit)}});
  }
}

void
RayCaster::findRays(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                    const Settings& settings, std::size_t begin, std::size_t end,
                    Part& part)
{
  const float range = float(settings.max_range);
  const kernels::RayStart start = rayStart(T_world_sensor, start_, settings.voxel_size);
  FreeSpace free_space(settings.clearing, settings.voxel_size, crossed_,
                       voxelOf(start_));
  kernels::RayBatch batch{};
  for (std::size_t i = begin; i < end; ++i) {
    if (ends_[i].x() == no_ray)
      continue;
    const Eigen::Vector3f point = scan.points[i];
    const float reach = reachOf(point);
    const std::size_t k = batch.count++;
    batch.point[k] = std::uint32_t(i);
    batch.x[k] = point.x();
    batch.y[k] = point.y();
    batch.z[k] = point.z();
    const double in_reach = reach <= range
                                ? free_space.fraction(ends_[i], double(point.norm()))
                                : double(range / reach);
    batch.fraction[k] = std::min(in_reach, sureFraction(scan, i));
    if (batch.count == kernels::RayBatch::capacity)
      addRays(start, batch, part);
  }
  addRays(start, batch, part);
}

void
RayCaster::addRays(const kernels::RayStart& start, kernels::RayBatch& batch, Part& part)
{
  kernels::findDirections(tier_)(start, batch);
  for (std::size_t k = 0; k < batch.count; ++k) {
    ends_[batch.point[k]] = {batch.end[0][k], batch.end[1][k], batch.end[2][k]};
    setRay(batch, k, part.rays.emplace_back());
    ++part.next[part.rays.back().tile];
  }
  batch.count = 0;
}

// Counting sort of the hits by slot.
void
RayCaster::sortHits()
{
  for (const std::uint32_t slot : hit_slots_)
    hit_count_[slot] = 0;
  hit_slots_.clear();
  std::size_t count = 0;
  for (const Part& part : parts_) {
    count += part.hits.size();
    for (const SlotHit& hit : part.hits)
      if (hit_count_[hit.slot]++ == 0)
        hit_slots_.push_back(hit.slot);
  }
  std::uint32_t first = 0;
  for (const std::uint32_t slot : hit_slots_) {
    first_hit_[slot] = first;
    first += hit_count_[slot];
    hit_count_[slot] = 0;
  }
  hits_.resize(count);
  for (const Part& part : parts_)
    for (const SlotHit& hit : part.hits)
      hits_[first_hit_[hit.slot] + hit_count_[hit.slot]++] = hit.hit;
}

// Sorts the rays by tile. Returns the index of the first ray of each tile and, as the
// last element, the number of rays.
std::vector<std::uint32_t>
RayCaster::sortRays()
{
  std::vector<std::uint32_t> first(tiles + 1);
  std::uint32_t count = 0;
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    first[tile] = count;
    for (Part& part : parts_)
      count += std::exchange(part.next[tile], count);
  }
  first[tiles] = count;
  rays_.resize(count);
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t p = 0; p < parts_.size(); ++p)
    for (const DirectedRay& ray : parts_[p].rays)
      rays_[parts_[p].next[ray.tile]++] = &ray;
  return first;
}

void
RayCaster::crossVoxels()
{
  const std::vector<std::uint32_t> first = sortRays();
  ParallelGuard guard;
#pragma omp parallel
  {
#pragma omp single nowait // other threads sweep tiles during the sort
    guard.run([&] { sortHits(); });
    std::optional<TileSweep> sweep;
    guard.run([&] { sweep.emplace(tier_, start_, ends_, crossed_); });
#pragma omp for schedule(dynamic, 1)
    for (std::size_t tile = 0; tile < tiles; ++tile)
      if (sweep && first[tile + 1] > first[tile])
        guard.run([&] {
          sweep->run(int(tile) / kTilesAFace, rays_.data() + first[tile],
                     first[tile + 1] - first[tile]);
        });
  }
  guard.rethrow();
}

ScanCounts
RayCaster::cast(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                const Grid& grid, const Settings& settings)
{
  crossed_.begin(grid);
  const std::size_t points = scan.points.size();
  start_ = quantize(T_world_sensor.translation(), settings.voxel_size);
  ends_.resize(points);
  parts_.resize((points + part_size - 1) / part_size);
  const auto forEachPart = [&](decltype(&RayCaster::findHits) find) {
    ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t p = 0; p < parts_.size(); ++p)
      guard.run([&] {
        (this->*find)(scan, T_world_sensor, settings, p * part_size,
                      std::min(points, (p + 1) * part_size), parts_[p]);
      });
    guard.rethrow();
  };
  for (Part& part : parts_) {
    part.rays.clear();
    part.hits.clear();
    part.next.assign(tiles, 0);
    part.invalid = part.sky = 0;
  }
  forEachPart(&RayCaster::findHits);
  if (settings.clearing != Clearing::none)
    forEachPart(&RayCaster::findRays);
  crossVoxels(); // sorts the hits too
  ScanCounts counts;
  counts.points = points;
  for (const Part& part : parts_) {
    counts.invalid += part.invalid;
    counts.sky += part.sky;
  }
  counts.rays = points - counts.invalid - counts.sky;
  return counts;
}

std::size_t
RayCaster::memory() const
{
  const auto bytes = [](const auto& values) {
    return values.capacity() *
           sizeof(typename std::decay_t<decltype(values)>::value_type);
  };
  std::size_t sum = crossed_.memory() + bytes(ends_) + bytes(parts_) + bytes(rays_) +
                    bytes(hits_) + bytes(first_hit_) + bytes(hit_count_) +
                    bytes(hit_slots_);
  for (const Part& part : parts_)
    sum += bytes(part.rays) + bytes(part.hits) + bytes(part.next);
  return sum;
}

} // namespace pcl_semantic
