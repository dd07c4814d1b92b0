/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

Eigen::Vector3i
windowInBlocks(const SemanticVoxelMap::Parameters& parameters)
{
  parameters.validate();
  // One more block: the window moves by whole blocks and still holds its extent.
  const double block = parameters.voxel_size * kBlockEdge;
  return ((parameters.window / block).array().min(1e6).ceil().cast<int>() + 1);
}

// A cloud's points are single precision: far from the world's origin they are given
// relative to a multiple of a kilometre.
Eigen::Vector3d
nearbyOrigin(const Eigen::Vector3d& sensor)
{
  constexpr double step = 1000.0;
  return (sensor / step).array().round() * step + 0.0; // no -0
}

} // namespace

SemanticVoxelMap::SemanticVoxelMap(const LabelSet& label_set,
                                   const Parameters& parameters,
                                   std::shared_ptr<BlockStore> store)
    : label_set_(label_set), parameters_(parameters),
      occupancy_update_(parameters.fusion),
      reader_(label_set.size(), parameters.fusion), grid_(windowInBlocks(parameters)),
      store_(store ? std::move(store) : std::make_shared<MemoryBlockStore>()),
      ray_caster_(grid_.slots())
{}

void
SemanticVoxelMap::centreWindow(const Eigen::Vector3d& sensor)
{
  const double farthest = 0.5 * kMaxVoxelIndex * parameters_.voxel_size;
  if (!((sensor.array().abs() <= farthest).all()))
    PCL_THROW_EXCEPTION(BadInputException, "the sensor is at "
                                               << sensor.transpose()
                                               << " m, expected at most " << farthest
                                               << " m from the origin");
  if (!has_cloud_origin_)
    setCloudOrigin(nearbyOrigin(sensor));
  const Eigen::Vector3d centre = sensor / (parameters_.voxel_size * kBlockEdge);
  const VoxelIndex origin =
      (centre - 0.5 * grid_.size().cast<double>()).array().round().cast<int>();
  grid_.scrollTo(
      origin,
      [&](const VoxelIndex& block, std::unique_ptr<VoxelBlock> content) {
        if (!content->changed)
          return; // the store has it
        content->changed = false;
        store_->put(block, *content);
      },
      [&](const VoxelIndex& block) { return store_->get(block); });
}

void
SemanticVoxelMap::flush()
{
  grid_.forEachSlot([&](const VoxelIndex& index, std::size_t slot) {
    VoxelBlock* const block = grid_.at(slot).get();
    if (!block || !block->changed)
      return;
    block->changed = false;
    store_->put(index, *block);
  });
}

void
SemanticVoxelMap::setCloudOrigin(const Eigen::Vector3d& origin)
{
  cloud_origin_ = origin;
  has_cloud_origin_ = true;
}

ScanCounts
SemanticVoxelMap::integrateScan(const Scan& scan,
                                const Eigen::Isometry3d& T_world_sensor)
{
  if (scan.points.size() >> RayHit::kPointBits)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a scan of " << scan.points.size() << " points is too large");
  if (scan.distributions &&
      (scan.distributions->classes() != label_set_.size() ||
       std::size_t(scan.distributions->size()) != scan.points.size()))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the label distributions are "
                            << scan.distributions->classes() << " x "
                            << scan.distributions->size() << ", expected "
                            << label_set_.size() << " x " << scan.points.size());
  if (!T_world_sensor.matrix().allFinite())
    PCL_THROW_EXCEPTION(BadInputException, "the pose of the sensor is not finite");
  centreWindow(T_world_sensor.translation());

  RayCaster::Settings settings{parameters_.voxel_size, parameters_.max_range, {}};
  for (int label = 0; label <= label_set_.size(); ++label)
    settings.is_sky.push_back(label_set_[Label(label)].sky);
  ScanCounts counts = ray_caster_.cast(scan, T_world_sensor, grid_, settings);
  updateOccupancy();
  fuseHits(scan);
  std::uint64_t last = ~std::uint64_t(0);
  for (const RayHit& hit : ray_caster_.hits()) {
    counts.hit_voxels += hit.voxel() != last;
    last = hit.voxel();
  }
  return counts;
}

void
SemanticVoxelMap::updateOccupancy()
{
  const CrossedVoxels& crossed = ray_caster_.crossed();
  const std::vector<VoxelIndex> blocks = crossed.blocks();
  const std::vector<RayHit>& hits = ray_caster_.hits();
  for (const VoxelIndex& index : blocks) {
    auto& block = grid_.at(grid_.slotOf(index));
    if (!block)
      block = std::make_unique<VoxelBlock>();
    block->changed = true;
  }
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const std::size_t slot = grid_.slotOf(blocks[b]);
    auto& block = grid_.at(slot);
    auto hit = std::lower_bound(hits.begin(), hits.end(), RayHit(slot, 0, 0));
    for (int place = 0; place < kBlockVoxels; ++place) {
      bool is_hit = false;
      for (; hit != hits.end() && hit->slot() == slot && hit->place() == place; ++hit)
        is_hit = true;
      if (is_hit)
        occupancy_update_.hit(block->log_odds[place]);
      else if (crossed.layer(slot, place >> 6) >> (place & 63) & 1)
        occupancy_update_.miss(block->log_odds[place]);
    }
  }
}

void
SemanticVoxelMap::fuseHits(const Scan& scan)
{
  const std::vector<RayHit>& hits = ray_caster_.hits();
  // First hits of voxels, by block: records grow, so a block belongs to one thread.
  std::vector<std::size_t> block_starts;
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (i == 0 || hits[i].slot() != hits[i - 1].slot())
      block_starts.push_back(i);
  const std::size_t block_count = block_starts.size();
  block_starts.push_back(hits.size());

  ParallelGuard guard; // records are made, which takes memory
#pragma omp parallel for schedule(dynamic, 16)
  for (std::size_t b = 0; b < block_count; ++b)
    guard.run([&] { fuseBlock(scan, block_starts[b], block_starts[b + 1]); });
  guard.rethrow();
}

void
SemanticVoxelMap::fuseBlock(const Scan& scan, std::size_t begin, std::size_t end)
{
  const int classes = label_set_.size();
  const std::vector<RayHit>& hits = ray_caster_.hits();
  VoxelBlock& block = *grid_.at(hits[begin].slot());
  VoxelMeasurement measurement(classes, parameters_.fusion);
  for (std::size_t i = begin; i < end;) {
    const RayHit first = hits[i];
    measurement.clear();
    for (; i < end && hits[i].voxel() == first.voxel(); ++i) {
      const std::size_t point = hits[i].point();
      if (!scan.rgb.empty())
        measurement.addColour(scan.rgb[point]);
      if (scan.distributions)
        measurement.addDistribution(scan.distributions->column(Eigen::Index(point)));
    }
    const int record = block.makeRecord(first.place(), classes);
    measurement.fuseInto(block.records[record],
                         block.measured.data() + record * classes);
    // What was concluded from older measurements does not hold any more.
    if (scan.distributions)
      std::fill_n(block.refined.begin() + record * classes, classes, 0.0f);
  }
}

void
SemanticVoxelMap::setRefined(const VoxelCloud& voxels,
                             const LabelDistributions& refined)
{
  const int classes = label_set_.size();
  if (std::size_t(refined.size()) != voxels.size() || refined.classes() != classes)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "refined distributions are "
                            << refined.classes() << " x " << refined.size()
                            << ", expected " << classes << " x " << voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const VoxelIndex& voxel = voxels.indices[i];
    VoxelBlock* const block = grid_.find(blockOf(voxel));
    if (!block)
      continue; // has left the window since
    const int record = block->recordAt(voxelInBlock(voxel));
    if (record == VoxelBlock::kNoRecord)
      continue;
    std::copy_n(refined.column(Eigen::Index(i)), classes,
                block->refined.data() + record * classes);
    block->changed = true;
  }
}

} // namespace pcl_semantic
