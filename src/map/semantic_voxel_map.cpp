// SPDX-License-Identifier: BSD-3-Clause
#include "block_update.h"
#include "dynamic_decay.h"
#include "ray_counting.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

void
checkScan(const Scan& scan, int classes)
{
  if (scan.points.size() >> 31)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a scan of " << scan.points.size() << " points is too large");
  if (scan.distributions &&
      (scan.distributions->classes() != classes ||
       std::size_t(scan.distributions->size()) != scan.points.size()))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the label distributions are "
                            << scan.distributions->classes() << " x "
                            << scan.distributions->size() << ", expected " << classes
                            << " x " << scan.points.size());
  if (scan.deviations && scan.deviations->size() != scan.points.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "there are " << scan.deviations->size()
                                     << " deviations, expected " << scan.points.size());
}

void
checkPose(const Eigen::Isometry3d& pose)
{
  if (!pose.matrix().allFinite())
    PCL_THROW_EXCEPTION(BadInputException, "the pose of the sensor is not finite");
  const Eigen::Matrix3d R = pose.linear();
  constexpr double tolerance = 1e-3; // rotations are read from texts of few digits
  if (!(R.transpose() * R).isIdentity(tolerance) || R.determinant() < 0.0)
    PCL_THROW_EXCEPTION(BadInputException,
                        "the pose of the sensor is no rotation and translation");
}

// Puts a block into the store unless that has it as it is.
void
keep(const VoxelIndex& index, VoxelBlock& block, BlockStore& store)
{
  if (!block.changed)
    return;
  store.put(index, block);
  block.changed = false;
}

// Replaces a fused distribution, see VoxelBlock::measured; one that says nothing, of a
// voxel without labels, leaves it.
void
replaceMeasured(const float* distribution, int classes, double max_ratio,
                float* log_distribution)
{
  const float largest = *std::max_element(distribution, distribution + classes);
  if (!(largest > 0.0f))
    return;
  for (int k = 0; k < classes; ++k)
    log_distribution[k] =
        float(std::log(std::max(double(distribution[k] / largest), 1.0 / max_ratio)));
}

} // namespace

SemanticVoxelMap::SemanticVoxelMap(const LabelSet& label_set,
                                   const Parameters& parameters,
                                   std::shared_ptr<BlockStore> store)
    : label_set_(label_set), parameters_(parameters),
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
    cloud_origin_ = nearbyOrigin(sensor);
  has_cloud_origin_ = true;
  const Eigen::Vector3d centre = sensor / (parameters_.voxel_size * kBlockEdge);
  const VoxelIndex origin =
      (centre - 0.5 * grid_.size().cast<double>()).array().round().cast<int>();
  grid_.scrollTo(
      origin,
      [&](const VoxelIndex& index, VoxelBlock& block) { keep(index, block, *store_); },
      [&](const VoxelIndex& index) {
        std::unique_ptr<VoxelBlock> block = store_->get(index);
        if (block)
          block->changed = false;
        return block;
      });
}

void
SemanticVoxelMap::moveWindow(const Eigen::Vector3d& centre)
{
  const auto writing = lock_.write();
  centreWindow(centre);
}

void
SemanticVoxelMap::flush()
{
  const auto writing = lock_.write();
  grid_.forEachSlot([&](const VoxelIndex& index, std::size_t slot) {
    if (grid_.at(slot))
      keep(index, *grid_.at(slot), *store_);
  });
}

void
SemanticVoxelMap::setCloudOrigin(const Eigen::Vector3d& origin)
{
  if (!origin.allFinite())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the origin of the clouds is not finite");
  const auto writing = lock_.write();
  cloud_origin_ = origin;
  has_cloud_origin_ = true;
}

ScanCounts
SemanticVoxelMap::integrateScan(const Scan& scan,
                                const Eigen::Isometry3d& T_world_sensor)
{
  checkScan(scan, label_set_.size());
  checkPose(T_world_sensor);
  const auto writing = lock_.write();
  centreWindow(T_world_sensor.translation());
  if (parameters_.fusion.dynamic_decay > 0.0)
    decayDynamicVoxels(label_set_, parameters_.fusion, grid_);
  RayCaster::Settings settings{parameters_.voxel_size, parameters_.max_range, {}};
  for (int label = 0; label <= label_set_.size(); ++label)
    settings.is_sky.push_back(label_set_[Label(label)].sky);
  ScanCounts counts = ray_caster_.cast(scan, T_world_sensor, grid_, settings);
  counts.hit_voxels = updateBlocks(scan);
  if (parameters_.fusion.per_ray_counting)
    countRays(ray_caster_, parameters_, scan, grid_);
  return counts;
}

std::size_t
SemanticVoxelMap::updateBlocks(const Scan& scan)
{
  const std::vector<VoxelIndex> blocks = ray_caster_.crossed().blocks();
  std::size_t hit_voxels = 0;
  ParallelGuard guard; // blocks and records are made, which takes memory
#pragma omp parallel reduction(+ : hit_voxels)
  {
    std::optional<BlockUpdate> update;
    guard.run([&] { update.emplace(label_set_.size(), parameters_, scan); });
#pragma omp for schedule(dynamic, 16)
    for (std::size_t b = 0; b < blocks.size(); ++b)
      guard.run([&] {
        const std::size_t slot = grid_.slotOf(blocks[b]);
        auto& block = grid_.at(slot);
        if (!block)
          block = std::make_unique<VoxelBlock>();
        const auto [first, last] = ray_caster_.hitsIn(slot);
        if (update)
          hit_voxels +=
              update->run(ray_caster_.crossed().layers(slot), first, last, *block);
      });
  }
  guard.rethrow();
  return hit_voxels;
}

void
SemanticVoxelMap::setRefined(const VoxelCloud& voxels,
                             const LabelDistributions& refined, bool as_measured)
{
  const int classes = label_set_.size();
  if (std::size_t(refined.size()) != voxels.size() || refined.classes() != classes)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "refined distributions are "
                            << refined.classes() << " x " << refined.size()
                            << ", expected " << classes << " x " << voxels.size());
  const auto isProbability = [](float p) { return p >= 0.0f && p <= 1.001f; };
  const auto& values = refined.matrix();
  if (!std::all_of(values.data(), values.data() + values.size(), isProbability))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a refined distribution holds a value that is no probability");
  const auto writing = lock_.write();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const VoxelIndex& voxel = voxels.indices[i];
    VoxelBlock* const block = grid_.find(blockOf(voxel));
    if (!block)
      continue; // has left the window since
    const int record = block->recordAt(voxelInBlock(voxel));
    if (record == VoxelBlock::kNoRecord)
      continue;
    const float* const distribution = refined.column(Eigen::Index(i));
    std::copy_n(distribution, classes, block->refined.data() + record * classes);
    if (as_measured)
      replaceMeasured(distribution, classes, parameters_.fusion.label_max_ratio,
                      block->measured.data() + record * classes);
    block->changed = true;
  }
}

const LabelSet&
SemanticVoxelMap::labelSet() const
{
  return label_set_;
}

const MapParameters&
SemanticVoxelMap::parameters() const
{
  return parameters_;
}

} // namespace pcl_semantic
