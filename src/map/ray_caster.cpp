/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/map/ray_caster.h>
#include <pcl_semantic/map/ray_traversal.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

QuantizedPoint
quantize(const Eigen::Vector3d& point, double voxel_size)
{
  const double scale = double(1 << kQuantizationBits) / voxel_size;
  return (point * scale).array().floor().cast<std::int64_t>();
}

// Sets the bits of crossed voxels. Words are shared between threads; setting a bit
// twice changes nothing, so the result does not depend on who comes first. The bits of
// one word are gathered first: a ray stays in a word for several voxels.
class CrossingMarker {
public:
  CrossingMarker(const RayCaster::Grid& grid, std::vector<std::uint64_t>& crossed,
                 std::vector<std::uint8_t>& touched, std::size_t words)
      : grid_(grid), crossed_(crossed), touched_(touched), words_(words)
  {}

  bool
  operator()(const VoxelIndex& voxel)
  {
    const VoxelIndex block = blockOf(voxel);
    if (block != block_ || !block_words_)
      if (!enter(block))
        return false; // the window is convex: a ray that left it does not come back
    const int place = voxelInBlock(voxel);
    std::uint64_t* const word = block_words_ + (place >> 6);
    if (word != word_) {
      flush();
      word_ = word;
    }
    bits_ |= std::uint64_t(1) << (place & 63);
    return true;
  }

  // Brings the gathered bits into their word; to be called after each ray.
  void
  flush()
  {
    if (bits_ & ~(word_ ? __atomic_load_n(word_, __ATOMIC_RELAXED) : bits_))
      __atomic_fetch_or(word_, bits_, __ATOMIC_RELAXED);
    bits_ = 0;
  }

private:
  bool
  enter(const VoxelIndex& block)
  {
    if (!grid_.contains(block))
      return false;
    const std::size_t slot = grid_.slotOf(block);
    block_ = block;
    block_words_ = crossed_.data() + slot * words_;
    __atomic_store_n(&touched_[slot], std::uint8_t(1), __ATOMIC_RELAXED);
    return true;
  }

  const RayCaster::Grid& grid_;
  std::vector<std::uint64_t>& crossed_;
  std::vector<std::uint8_t>& touched_;
  std::size_t words_;
  VoxelIndex block_ = VoxelIndex::Zero();
  std::uint64_t* block_words_ = nullptr;
  std::uint64_t* word_ = nullptr;
  std::uint64_t bits_ = 0;
};

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

} // namespace

RayCaster::RayCaster(std::size_t slots) : crossed_(slots * kWords), touched_(slots)
{}

void
RayCaster::clear(const Grid& grid)
{
  // The window may have moved since, but a slot's bits stay where they are.
  for (std::size_t slot = 0; slot < grid.slots(); ++slot)
    if (touched_[slot]) {
      std::fill_n(crossed_.begin() + long(slot * kWords), kWords, 0);
      touched_[slot] = 0;
    }
  crossed_blocks_.clear();
  hits_.clear();
}

void
RayCaster::findCrossedBlocks(const Grid& grid)
{
  grid.forEachSlot([&](const VoxelIndex& block, std::size_t slot) {
    if (touched_[slot])
      crossed_blocks_.push_back(block);
  });
}

ScanCounts
RayCaster::cast(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                const Grid& grid, const Settings& settings)
{
  clear(grid);
  const QuantizedPoint start =
      quantize(T_world_sensor.translation(), settings.voxel_size);
  const float range = float(settings.max_range);
  std::size_t invalid = 0, sky = 0, rays = 0;
  ParallelGuard guard; // hits are gathered, which takes memory
#pragma omp parallel reduction(+ : invalid, sky, rays)
  {
    CrossingMarker mark(grid, crossed_, touched_, kWords);
    std::vector<RayHit> hits;
#pragma omp for schedule(dynamic, 4096) nowait
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
      ++rays;
      const bool in_range = reach <= range;
      const double share = in_range ? 1.0 : double(range / reach);
      const QuantizedPoint end =
          quantize(T_world_sensor * (share * scan.points[i].cast<double>()),
                   settings.voxel_size);
      traverseSegment(start, end, mark);
      mark.flush();
      const VoxelIndex voxel = voxelOf(end);
      const VoxelIndex block = blockOf(voxel);
      if (in_range && grid.contains(block))
        guard.run(
            [&] { hits.emplace_back(grid.slotOf(block), voxelInBlock(voxel), i); });
    }
#pragma omp critical
    guard.run([&] { hits_.insert(hits_.end(), hits.begin(), hits.end()); });
  }
  guard.rethrow();
  std::sort(hits_.begin(), hits_.end());
  findCrossedBlocks(grid);
  return {scan.points.size(), rays, invalid, sky, 0};
}

} // namespace pcl_semantic
