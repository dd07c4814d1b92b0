// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/map/semantic_voxel_map.h>

#include "block_reader.h"
#include "block_update.h"
#include "core/fail.h"
#include "core/parallel_guard.h"
#include "core/probabilities.h"
#include "ray_caster.h"
#include "ray_traversal.h"
#include "read_write_lock.h"
#include "scrolling_voxel_grid.h"
#include "seen_past.h"
#include "voxel_fusion.h"

#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/core/threads.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace pcl_semantic {

struct SemanticVoxelMap::State {
  State(const LabelSet& label_set, const MapParameters& parameters,
        std::shared_ptr<BlockStore> store);

  void centreWindow(const Eigen::Vector3d& sensor);
  ScanCounts integrate(const Scan& scan, const Eigen::Isometry3d& T_world_sensor);
  std::size_t updateBlocks(const Scan& scan);
  std::size_t addLabels(const Scan& scan, const Eigen::Isometry3d& T_world_sensor);
  void setRefined(const VoxelCloud& voxels, const LabelDistributions& refined,
                  std::size_t begin, std::size_t end, bool as_measured,
                  VoxelBlock& block) const;
  const VoxelBlock* findVoxel(const Eigen::Vector3d& point, int& offset) const;
  void visitBlocks(const VisitBlock& visit) const;

  LabelSet label_set;
  MapParameters parameters;
  BlockReader reader;
  ScrollingVoxelGrid<VoxelBlock> grid;
  std::shared_ptr<BlockStore> store;
  RayCaster ray_caster;
  Eigen::Vector3d cloud_origin = Eigen::Vector3d::Zero();
  bool has_cloud_origin = false;
  double depth_error = 0.0; // see Scan
  std::optional<int> threads;
  ReadWriteLock lock;               // of everything above
  mutable std::mutex store_reading; // a store need not support several readers
};

namespace {

Eigen::Vector3i
windowInBlocks(const SemanticVoxelMap::Parameters& parameters)
{
  parameters.validate();
  // One more block: the window moves by whole blocks and must still contain its extent.
  const double block = parameters.voxel_size * kBlockEdge;
  return ((parameters.window / block).array().min(1e6).ceil().cast<int>() + 1);
}

// Clouds have single precision, so far from the world's origin their origin is a
// multiple of a kilometre near the sensor.
Eigen::Vector3d
nearbyOrigin(const Eigen::Vector3d& sensor)
{
  constexpr double step = 1000.0;
  return (sensor / step).array().round() * step + 0.0; // avoids -0
}

void
checkScan(const Scan& scan, int classes)
{
  if (scan.points.size() >> 31)
    badParameter("a scan of ", scan.points.size(), " points is too large");
  if (scan.distributions &&
      (scan.distributions->classes() != classes ||
       std::size_t(scan.distributions->size()) != scan.points.size()))
    badParameter("the label distributions are ", scan.distributions->classes(), " x ",
                 scan.distributions->size(), ", expected ", classes, " x ",
                 scan.points.size());
  if (scan.deviations && scan.deviations->size() != scan.points.size())
    badParameter("there are ", scan.deviations->size(), " deviations, expected ",
                 scan.points.size());
}

// Stores a block if it has changed.
void
keep(const VoxelIndex& index, VoxelBlock& block, BlockStore& store)
{
  if (!block.changed)
    return;
  store.put(index, block);
  block.changed = false;
}

// Replaces a fused distribution, see VoxelBlock::measured, unless the new one is all
// zero.
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

bool
isNear(const Eigen::Vector3d& point, double voxel_size)
{
  return (point.array().abs() <= kMaxVoxelIndex * voxel_size).all(); // false for NaN
}

} // namespace

SemanticVoxelMap::State::State(const LabelSet& classes, const MapParameters& p,
                               std::shared_ptr<BlockStore> given)
    : label_set(classes), parameters(p.withWindow()), reader(classes.size(), p),
      grid(windowInBlocks(parameters)),
      store(given ? std::move(given) : std::make_shared<MemoryBlockStore>()),
      ray_caster(grid.slots())
{}

void
SemanticVoxelMap::State::centreWindow(const Eigen::Vector3d& sensor)
{
  const double farthest = 0.5 * kMaxVoxelIndex * parameters.voxel_size;
  if (!((sensor.array().abs() <= farthest).all()))
    badInput("the sensor is at ", sensor.transpose(), " m, expected at most ", farthest,
             " m from the origin");
  if (!has_cloud_origin)
    cloud_origin = nearbyOrigin(sensor);
  has_cloud_origin = true;
  const Eigen::Vector3d centre = sensor / (parameters.voxel_size * kBlockEdge);
  const VoxelIndex origin =
      (centre - 0.5 * grid.size().cast<double>()).array().round().cast<int>();
  grid.scrollTo(
      origin,
      [&](const VoxelIndex& index, VoxelBlock& block) { keep(index, block, *store); },
      [&](const VoxelIndex& index) {
        std::unique_ptr<VoxelBlock> block = store->get(index);
        if (block)
          block->changed = false;
        return block;
      });
}

ScanCounts
SemanticVoxelMap::State::integrate(const Scan& scan,
                                   const Eigen::Isometry3d& T_world_sensor)
{
  centreWindow(T_world_sensor.translation());
  RayCaster::Settings settings{
      parameters.voxel_size, parameters.max_range, {}, parameters.fusion.clearing};
  for (int label = 0; label <= label_set.size(); ++label)
    settings.is_sky.push_back(label_set[Label(label)].sky);
  ScanCounts counts = ray_caster.cast(scan, T_world_sensor, grid, settings);
  counts.hit_voxels = updateBlocks(scan);
  if (parameters.fusion.per_ray_counting)
    countRays(ray_caster, parameters, scan, grid);
  if (parameters.fusion.free_dynamic)
    counts.freed =
        freeSeenPast(label_set, parameters, scan, T_world_sensor, ray_caster, grid);
  return counts;
}

std::size_t
SemanticVoxelMap::State::updateBlocks(const Scan& scan)
{
  const std::vector<VoxelIndex> blocks = ray_caster.crossed().blocks();
  std::size_t hit_voxels = 0;
  ParallelGuard guard; // allocates blocks and records
#pragma omp parallel reduction(+ : hit_voxels)
  {
    std::optional<BlockUpdate> update;
    guard.run([&] { update.emplace(label_set, parameters, scan); });
#pragma omp for schedule(dynamic, 16)
    for (std::size_t b = 0; b < blocks.size(); ++b)
      guard.run([&] {
        const std::size_t slot = grid.slotOf(blocks[b]);
        auto& block = grid.at(slot);
        if (!block)
          block = std::make_unique<VoxelBlock>();
        const auto [first, last] = ray_caster.hitsIn(slot);
        if (update)
          hit_voxels +=
              update->run(ray_caster.crossed().layers(slot), first, last, *block);
      });
  }
  guard.rethrow();
  return hit_voxels;
}

std::size_t
SemanticVoxelMap::State::addLabels(const Scan& scan,
                                   const Eigen::Isometry3d& T_world_sensor)
{
  struct End {
    std::size_t slot;
    int offset;
    std::uint32_t point;
  };
  std::vector<End> ends; // in voxels that a scan has hit
  for (std::uint32_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3f point = scan.points[i];
    const Label label = scan.distributions->mapLabel(i);
    const bool is_return = !point.isZero(0.0f);
    if (!is_return || label == kUnlabelled || label_set[label].sky ||
        !(point.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <=
          float(parameters.max_range)))
      continue;
    const VoxelIndex voxel = pcl_semantic::voxelOf(
        quantize(T_world_sensor * point.cast<double>(), parameters.voxel_size));
    if (!grid.contains(blockOf(voxel)))
      continue;
    const std::size_t slot = grid.slotOf(blockOf(voxel));
    const int offset = voxelInBlock(voxel);
    if (grid.at(slot) && grid.at(slot)->recordAt(offset) != VoxelBlock::kNoRecord)
      ends.push_back({slot, offset, i});
  }
  const auto voxelOfEnd = [](const End& end) {
    return std::pair(end.slot, end.offset);
  };
  std::sort(ends.begin(), ends.end(),
            [&](const End& a, const End& b) { return voxelOfEnd(a) < voxelOfEnd(b); });
  VoxelMeasurement measurement(label_set.size(), parameters.fusion);
  const LabelDeviations deviations(parameters, scan);
  std::size_t voxels = 0;
  for (std::size_t first = 0, last = 0; first < ends.size(); first = last, ++voxels) {
    measurement.clear();
    for (; last < ends.size() && voxelOfEnd(ends[last]) == voxelOfEnd(ends[first]);
         ++last)
      measurement.addDistribution(scan.distributions->column(ends[last].point),
                                  deviations.of(ends[last].point));
    VoxelBlock& block = *grid.at(ends[first].slot);
    const auto record = std::size_t(block.recordAt(ends[first].offset));
    const auto row = std::ptrdiff_t(record) * label_set.size();
    measurement.fuseLabels(block.records[record], block.measured.data() + row);
    std::fill_n(block.refined.begin() + row, label_set.size(), 0.0f);
    block.changed = true;
  }
  return voxels;
}

// Voxels of one block.
void
SemanticVoxelMap::State::setRefined(const VoxelCloud& voxels,
                                    const LabelDistributions& refined,
                                    std::size_t begin, std::size_t end,
                                    bool as_measured, VoxelBlock& block) const
{
  const int classes = label_set.size();
  for (std::size_t i = begin; i < end; ++i) {
    const int record = block.recordAt(voxelInBlock(voxels.indices[i]));
    if (record == VoxelBlock::kNoRecord)
      continue;
    const float* const distribution = refined.column(Eigen::Index(i));
    float* const stored = block.refined.data() + record * classes;
    if (!as_measured && std::equal(distribution, distribution + classes, stored))
      continue; // so that the store need not write the block again
    std::copy_n(distribution, classes, stored);
    if (as_measured)
      replaceMeasured(distribution, classes, parameters.fusion.label_max_ratio,
                      block.measured.data() + record * classes);
    block.changed = true;
  }
}

const VoxelBlock*
SemanticVoxelMap::State::findVoxel(const Eigen::Vector3d& point, int& offset) const
{
  if (!isNear(point, parameters.voxel_size))
    return nullptr;
  const VoxelIndex voxel =
      pcl_semantic::voxelOf(quantize(point, parameters.voxel_size));
  offset = voxelInBlock(voxel);
  return grid.find(blockOf(voxel));
}

void
SemanticVoxelMap::State::visitBlocks(const VisitBlock& visit) const
{
  const std::lock_guard<std::mutex> alone(store_reading);
  // Merges two ordered lists; for a block in both, the window has the newer state.
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> window;
  grid.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    window.emplace_back(index, &block);
  });
  auto next = window.begin();
  const auto visitWindowBefore = [&](const VoxelIndex& index) {
    for (; next != window.end() && VoxelIndexLess()(next->first, index); ++next)
      visit(next->first, *next->second);
  };
  store->forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    visitWindowBefore(index);
    if (!grid.contains(index))
      visit(index, block);
  });
  for (; next != window.end(); ++next)
    visit(next->first, *next->second);
}

SemanticVoxelMap::SemanticVoxelMap(const LabelSet& label_set,
                                   const Parameters& parameters,
                                   std::shared_ptr<BlockStore> store)
    : state_(std::make_unique<State>(label_set, parameters, std::move(store)))
{}

SemanticVoxelMap::~SemanticVoxelMap() = default;

void
SemanticVoxelMap::moveWindow(const Eigen::Vector3d& centre)
{
  const auto writing = state_->lock.write();
  state_->centreWindow(centre);
}

void
SemanticVoxelMap::flush()
{
  const auto writing = state_->lock.write();
  state_->grid.forEachSlot([&](const VoxelIndex& index, std::size_t slot) {
    if (state_->grid.at(slot))
      keep(index, *state_->grid.at(slot), *state_->store);
  });
}

void
SemanticVoxelMap::setCloudOrigin(const Eigen::Vector3d& origin)
{
  if (!origin.allFinite())
    badParameter("the origin of the clouds is not finite");
  const auto writing = state_->lock.write();
  state_->cloud_origin = origin;
  state_->has_cloud_origin = true;
}

ScanCounts
SemanticVoxelMap::integrateScan(const Scan& scan,
                                const Eigen::Isometry3d& T_world_sensor)
{
  checkScan(scan, state_->label_set.size());
  requireRigid(T_world_sensor, "the pose of the sensor");
  const auto writing = state_->lock.write();
  const ThreadScope threads(state_->threads);
  if (scan.distributions)
    requireProbabilities(*scan.distributions);
  Scan measured = scan;
  measured.depth_error = state_->depth_error;
  return state_->integrate(measured, T_world_sensor);
}

void
SemanticVoxelMap::setDepthError(double error)
{
  if (!(error >= 0.0 && std::isfinite(error)))
    badParameter("the depth error is ", error, ", expected 0 or more");
  const auto writing = state_->lock.write();
  state_->depth_error = error;
}

double
SemanticVoxelMap::depthError() const
{
  const auto reading = state_->lock.read();
  return state_->depth_error;
}

std::size_t
SemanticVoxelMap::addScanLabels(const Scan& scan,
                                const Eigen::Isometry3d& T_world_sensor)
{
  checkScan(scan, state_->label_set.size());
  requireRigid(T_world_sensor, "the pose of the sensor");
  requireProbabilities(*scan.distributions);
  const auto writing = state_->lock.write();
  Scan measured = scan;
  measured.depth_error = state_->depth_error;
  return state_->addLabels(measured, T_world_sensor);
}

void
SemanticVoxelMap::setRefined(const VoxelCloud& voxels,
                             const LabelDistributions& refined, bool as_measured)
{
  const int classes = state_->label_set.size();
  if (std::size_t(refined.size()) != voxels.size() || refined.classes() != classes)
    badParameter("refined distributions are ", refined.classes(), " x ", refined.size(),
                 ", expected ", classes, " x ", voxels.size());
  const auto values = refined.matrix().array();
  if (!(values >= 0.0f && values <= 1.001f).all()) // or NaN
    badParameter("a refined distribution holds a value that is no probability");
  const auto writing = state_->lock.write();
  const ThreadScope threads(state_->threads);
  const auto blockAt = [&](std::size_t i) { return blockOf(voxels.indices[i]); };
  std::vector<std::size_t> firsts; // start of each block's consecutive voxels
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (i == 0 || blockAt(i) != blockAt(i - 1))
      firsts.push_back(i);
  firsts.push_back(voxels.size());
#pragma omp parallel for schedule(static)
  for (std::size_t b = 0; b < firsts.size() - 1; ++b)
    if (VoxelBlock* const block = state_->grid.find(blockAt(firsts[b])))
      state_->setRefined(voxels, refined, firsts[b], firsts[b + 1], as_measured,
                         *block);
  // Otherwise it has left the window.
}

void
SemanticVoxelMap::setFree(const std::vector<VoxelIndex>& voxels)
{
  const auto writing = state_->lock.write();
  const OccupancyUpdate occupancy(state_->parameters.fusion);
  for (const VoxelIndex& voxel : voxels)
    if (VoxelBlock* const block = state_->grid.find(blockOf(voxel)))
      freeVoxel(*block, voxelInBlock(voxel), state_->label_set.size(), occupancy);
}

Eigen::AlignedBox<int, 3>
SemanticVoxelMap::window() const
{
  const auto reading = state_->lock.read();
  const VoxelIndex& origin = state_->grid.origin();
  if ((origin.array().abs() > kMaxVoxelIndex / kBlockEdge).any())
    return {}; // no scan yet
  const VoxelIndex first = kBlockEdge * origin;
  return {first, first + kBlockEdge * state_->grid.size() - VoxelIndex::Ones()};
}

const LabelSet&
SemanticVoxelMap::labelSet() const
{
  return state_->label_set;
}

const MapParameters&
SemanticVoxelMap::parameters() const
{
  return state_->parameters;
}

namespace {

Label
labelOf(const BlockReader& reader, const VoxelBlock* block, int offset)
{
  return block && reader.isOccupied(*block, offset) ? reader.label(*block, offset)
                                                    : kUnlabelled;
}

// Where a segment enters a box: the wall that it passes last.
struct Entry {
  int axis = 0;
  int slab = 0; ///< voxels from the start along the axis
};

// 64 bits: an empty window is far beyond all voxels.
using WideIndex = Eigen::Matrix<std::int64_t, 3, 1>;

// \param[in] low, high the first and the last voxel of the box
// \return nothing if the segment does not reach the box
std::optional<Entry>
entryOf(const QuantizedPoint& from, const QuantizedPoint& to, const WideIndex& low,
        const WideIndex& high)
{
  const WideIndex start = voxelOf(from).cast<std::int64_t>();
  const WideIndex end = voxelOf(to).cast<std::int64_t>();
  Entry entry;
  double latest = 0.0; // as fraction of the segment
  for (int axis = 0; axis < 3; ++axis) {
    if (std::max(start[axis], end[axis]) < low[axis] ||
        std::min(start[axis], end[axis]) > high[axis])
      return std::nullopt;
    const std::int64_t slab =
        std::max(low[axis] - start[axis], start[axis] - high[axis]);
    const double time = double(slab) / std::abs(double(end[axis] - start[axis]));
    if (slab > 0 && time > latest) {
      latest = time;
      entry = {axis, int(slab)};
    }
  }
  return entry;
}

} // namespace

VoxelCloud
SemanticVoxelMap::occupied() const
{
  const auto reading = state_->lock.read();
  const ThreadScope threads(state_->threads);
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> blocks;
  state_->grid.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    if (!block.records.empty())
      blocks.emplace_back(index, &block);
  });
  return state_->reader.readAll(blocks, state_->cloud_origin);
}

VoxelCloud
SemanticVoxelMap::occupiedEverywhere() const
{
  const auto reading = state_->lock.read();
  std::size_t count = 0;
  state_->visitBlocks([&](const VoxelIndex&, const VoxelBlock& block) {
    count += state_->reader.countOccupied(block);
  });
  VoxelCloud voxels = state_->reader.makeCloud(count, state_->parameters.voxel_size,
                                               state_->cloud_origin);
  std::size_t first = 0;
  state_->visitBlocks([&](const VoxelIndex& index, const VoxelBlock& block) {
    state_->reader.read(index, block, first, voxels);
    first += state_->reader.countOccupied(block);
  });
  return voxels;
}

void
SemanticVoxelMap::forEachBlock(const VisitBlock& visit) const
{
  const auto reading = state_->lock.read();
  state_->visitBlocks(visit);
}

VoxelIndex
SemanticVoxelMap::voxelOf(const Eigen::Vector3d& point) const
{
  if (!isNear(point, state_->parameters.voxel_size))
    badParameter("a point at ", point.transpose(), " m lies in no voxel");
  return pcl_semantic::voxelOf(quantize(point, state_->parameters.voxel_size));
}

Occupancy
SemanticVoxelMap::occupancy(const Eigen::Vector3d& point) const
{
  const auto reading = state_->lock.read();
  int offset = 0;
  const VoxelBlock* const block = state_->findVoxel(point, offset);
  return block ? state_->reader.occupancy(*block, offset) : Occupancy::unknown;
}

std::vector<Label>
SemanticVoxelMap::labels(const std::vector<Eigen::Vector3d>& points) const
{
  const auto reading = state_->lock.read();
  const ThreadScope threads(state_->threads);
  std::vector<Label> labels(points.size());
#pragma omp parallel for schedule(dynamic, 4096)
  for (std::size_t i = 0; i < points.size(); ++i) {
    int offset = 0;
    const VoxelBlock* const block = state_->findVoxel(points[i], offset);
    labels[i] = labelOf(state_->reader, block, offset);
  }
  return labels;
}

VoxelState
SemanticVoxelMap::state(const Eigen::Vector3d& point) const
{
  const auto reading = state_->lock.read();
  int offset = 0;
  if (const VoxelBlock* const block = state_->findVoxel(point, offset))
    return state_->reader.state(blockOf(voxelOf(point)), *block, offset);
  VoxelState unknown = state_->reader.state(VoxelIndex::Zero(), VoxelBlock(), 0);
  if (isNear(point, state_->parameters.voxel_size))
    unknown.index = voxelOf(point);
  return unknown;
}

std::vector<VoxelState>
SemanticVoxelMap::states(const Eigen::AlignedBox3d& box) const
{
  const auto reading = state_->lock.read();
  const double farthest = kMaxVoxelIndex * state_->parameters.voxel_size;
  std::vector<VoxelState> states;
  if (!(box.min().array() <= box.max().array()).all()) // or NaN
    return states;
  const VoxelIndex low = voxelOf(box.min().cwiseMax(-farthest).cwiseMin(farthest));
  const VoxelIndex high = voxelOf(box.max().cwiseMax(-farthest).cwiseMin(farthest));
  state_->grid.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    if ((index.array() < blockOf(low).array()).any() ||
        (index.array() > blockOf(high).array()).any())
      return;
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const Eigen::Array3i voxel = voxelAt(index, offset).array();
      if (block.log_odds[std::size_t(offset)] != kUnknown &&
          (voxel >= low.array()).all() && (voxel <= high.array()).all())
        states.push_back(state_->reader.state(index, block, offset));
    }
  });
  return states;
}

std::optional<VoxelState>
SemanticVoxelMap::firstOccupied(const Eigen::Vector3d& from,
                                const Eigen::Vector3d& to) const
{
  const auto reading = state_->lock.read();
  std::optional<VoxelState> found;
  const double voxel_size = state_->parameters.voxel_size;
  if (!isNear(from, voxel_size) || !isNear(to, voxel_size))
    return found;
  bool inside = false;
  const auto visit = [&](const VoxelIndex& voxel) {
    if (!state_->grid.contains(blockOf(voxel)))
      return !inside; // it cannot enter again
    inside = true;
    const VoxelBlock* const block = state_->grid.find(blockOf(voxel));
    const int offset = voxelInBlock(voxel);
    if (block && state_->reader.isOccupied(*block, offset))
      found = state_->reader.state(blockOf(voxel), *block, offset);
    return !found;
  };
  const QuantizedPoint start = quantize(from, voxel_size),
                       end = quantize(to, voxel_size);
  const WideIndex low = state_->grid.origin().cast<std::int64_t>() * kBlockEdge;
  const WideIndex high =
      low + state_->grid.size().cast<std::int64_t>() * kBlockEdge - WideIndex::Ones();
  if (const std::optional<Entry> entry = entryOf(start, end, low, high))
    traverseSegmentFrom(start, end, entry->axis, entry->slab, visit);
  return found;
}

void
SemanticVoxelMap::setNumberOfThreads(int threads)
{
  const auto writing = state_->lock.write();
  state_->threads = threads;
}

std::size_t
SemanticVoxelMap::memory() const
{
  const auto reading = state_->lock.read();
  std::size_t bytes = state_->grid.slots() * sizeof(std::unique_ptr<VoxelBlock>);
  state_->grid.forEach(
      [&](const VoxelIndex&, const VoxelBlock& block) { bytes += memoryOf(block); });
  return bytes + state_->ray_caster.memory();
}

Eigen::Vector3d
SemanticVoxelMap::cloudOrigin() const
{
  const auto reading = state_->lock.read();
  return state_->cloud_origin;
}

} // namespace pcl_semantic
