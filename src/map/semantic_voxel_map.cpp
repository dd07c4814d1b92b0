// SPDX-License-Identifier: BSD-3-Clause
#include "core/parallel_guard.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/map/block_reader.h>
#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/ray_caster.h>
#include <pcl_semantic/map/semantic_voxel.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/map/voxel_fusion.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

// What SemanticVoxelMap gives out: clouds of occupied voxels and the state of a place.

namespace pcl_semantic {

/** \brief Brings what one scan says into a block: one update of occupancy a voxel, a
 * hit wins over a miss; colours and labels of the voxels that were hit. */
class BlockUpdate {
public:
  /** \param[in] classes L */
  BlockUpdate(int classes, const MapParameters& parameters, const Scan& scan);

  /** \param[in] crossed voxels, see CrossedVoxels::layers
   * \param[in] first, last hits in the block, in any order
   * \return number of voxels that were hit */
  std::size_t run(const std::uint64_t* crossed, const RayHit* first, const RayHit* last,
                  VoxelBlock& block);

private:
  void sortByPlace(const RayHit* first, const RayHit* last);

  void updateOccupancy(const std::uint64_t* crossed, VoxelBlock& block) const;

  float weightOf(std::size_t begin, std::size_t end) const;

  void fuse(int place, std::size_t begin, std::size_t end, VoxelBlock& block);

  const int classes_;
  const OccupancyUpdate occupancy_;
  const bool per_ray_;
  const double voxel_size_;
  const Scan& scan_;
  VoxelMeasurement measurement_;
  std::array<std::uint64_t, CrossedVoxels::kWords> hit_{}; // a bit a voxel
  std::array<std::uint32_t, kBlockVoxels> end_{};          // of its points, by voxel
  std::vector<std::uint32_t> points_;                      // by voxel
};

/** \brief Takes FusionParameters::dynamic_decay off every occupied voxel of the window
 * whose MAP label is of a dynamic class. */
void decayDynamicVoxels(const LabelSet& label_set, const FusionParameters& fusion,
                        RayCaster::Grid& grid);

/** \brief Counts every ray of a scan in the occupancy of its voxels, as the
 * paper does: one after the other by a single thread, for here their order matters.
 * \param[in] scan that \a caster has cast last
 * \param[in,out] grid that the rays were cast through; all crossed blocks are there */
void countRays(const RayCaster& caster, const MapParameters& parameters,
               const Scan& scan, RayCaster::Grid& grid);

namespace {

// Calls visit(place) for every bit that is set, in order.
template <typename Visit>
void
forEachBit(const std::uint64_t* words, Visit&& visit)
{
  for (std::size_t w = 0; w < CrossedVoxels::kWords; ++w)
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1)
      visit(int(64 * w) + __builtin_ctzll(bits));
}

} // namespace

BlockUpdate::BlockUpdate(int classes, const MapParameters& parameters, const Scan& scan)
    : classes_(classes), occupancy_(parameters.fusion),
      per_ray_(parameters.fusion.per_ray_counting), voxel_size_(parameters.voxel_size),
      scan_(scan), measurement_(classes, parameters.fusion)
{}

std::size_t
BlockUpdate::run(const std::uint64_t* crossed, const RayHit* first, const RayHit* last,
                 VoxelBlock& block)
{
  block.changed = true;
  sortByPlace(first, last);
  if (!per_ray_) // else it has been updated ray by ray
    updateOccupancy(crossed, block);
  std::size_t hit_voxels = 0;
  std::size_t begin = 0;
  forEachBit(hit_.data(), [&](int place) {
    fuse(place, begin, end_[std::size_t(place)], block);
    begin = end_[std::size_t(place)];
    ++hit_voxels;
  });
  return hit_voxels;
}

void
BlockUpdate::sortByPlace(const RayHit* first, const RayHit* last)
{
  hit_.fill(0);
  for (const RayHit* hit = first; hit != last; ++hit) {
    std::uint64_t& word = hit_[hit->place >> 6];
    const std::uint64_t bit = std::uint64_t(1) << (hit->place & 63);
    end_[hit->place] = word & bit ? end_[hit->place] + 1 : 1;
    word |= bit;
  }
  std::uint32_t begin = 0;
  forEachBit(hit_.data(), [&](int place) {
    const std::uint32_t count = end_[std::size_t(place)];
    end_[std::size_t(place)] = begin;
    begin += count;
  });
  points_.resize(std::size_t(last - first));
  for (const RayHit* hit = first; hit != last; ++hit) {
    points_[end_[hit->place]++] = hit->point;
    // Neighbours in the map are none in the scan.
    if (!scan_.rgb.empty())
      __builtin_prefetch(scan_.rgb.address(hit->point));
    if (scan_.distributions)
      __builtin_prefetch(scan_.distributions->column(Eigen::Index(hit->point)));
  }
}

void
BlockUpdate::updateOccupancy(const std::uint64_t* crossed, VoxelBlock& block) const
{
  for (std::size_t w = 0; w < CrossedVoxels::kWords; ++w) {
    const std::uint64_t missed = crossed[w] & ~hit_[w];
    StoredLogOdds* const layer = block.log_odds.data() + 64 * w;
    if (missed == ~std::uint64_t(0)) // the loop that compilers make wide
      for (int i = 0; i < 64; ++i)
        occupancy_.miss(layer[i]);
    else
      for (std::uint64_t bits = missed; bits != 0; bits &= bits - 1)
        occupancy_.miss(layer[__builtin_ctzll(bits)]);
  }
  std::size_t begin = 0;
  forEachBit(hit_.data(), [&](int place) {
    const std::size_t end = end_[std::size_t(place)];
    occupancy_.hit(block.log_odds[std::size_t(place)], weightOf(begin, end));
    begin = end;
  });
}

// That of the surest point: their order does not matter.
float
BlockUpdate::weightOf(std::size_t begin, std::size_t end) const
{
  if (!scan_.deviations)
    return 1.0f;
  float least = std::numeric_limits<float>::max();
  for (std::size_t i = begin; i < end; ++i)
    least = std::min(least, (*scan_.deviations)[points_[i]]);
  return hitWeight(voxel_size_, least);
}

void
BlockUpdate::fuse(int place, std::size_t begin, std::size_t end, VoxelBlock& block)
{
  measurement_.clear();
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t point = points_[i];
    if (!scan_.rgb.empty())
      measurement_.addColour(scan_.rgb[point]);
    if (scan_.distributions)
      measurement_.addDistribution(scan_.distributions->column(Eigen::Index(point)));
  }
  const int record = block.makeRecord(place, classes_);
  const bool labelled = measurement_.fuseInto(
      block.records[std::size_t(record)], block.measured.data() + record * classes_);
  // What was concluded from older measurements does not hold any more.
  if (labelled)
    std::fill_n(block.refined.begin() + record * classes_, classes_, 0.0f);
}

void
decayDynamicVoxels(const LabelSet& label_set, const FusionParameters& fusion,
                   RayCaster::Grid& grid)
{
  const OccupancyUpdate update(fusion);
  const BlockReader reader(label_set.size(), fusion);
  const int units = static_cast<int>(std::lround(fusion.dynamic_decay / kLogOddsUnit));
  std::array<bool, 256> dynamic{};
  for (int label = 1; label <= label_set.size(); ++label)
    dynamic[std::size_t(label)] = label_set[Label(label)].dynamic;
#pragma omp parallel for schedule(dynamic, 1024)
  for (std::size_t slot = 0; slot < grid.slots(); ++slot) {
    VoxelBlock* const block = grid.at(slot).get();
    if (!block || block->records.empty())
      continue;
    for (int place = 0; place < kBlockVoxels; ++place)
      if (reader.isOccupied(*block, place) && dynamic[reader.label(*block, place)]) {
        update.decay(block->log_odds[std::size_t(place)], units);
        block->changed = true;
      }
  }
}

void
countRays(const RayCaster& caster, const MapParameters& parameters, const Scan& scan,
          RayCaster::Grid& grid)
{
  const OccupancyUpdate update(parameters.fusion);
  caster.forEachRay([&](const QuantizedPoint& start, const QuantizedPoint& end,
                        const RayCaster::SlotHit* hit) {
    traverseSegment(start, end, [&](const VoxelIndex& voxel) {
      const VoxelIndex index = blockOf(voxel);
      if (!grid.contains(index))
        return false;
      const std::size_t slot = grid.slotOf(index);
      const auto place = std::uint32_t(voxelInBlock(voxel));
      if (!hit || hit->slot != slot || hit->hit.place != place)
        update.miss(grid.at(slot)->log_odds[place]);
      return true;
    });
    if (!hit)
      return;
    const float deviation = scan.deviations ? (*scan.deviations)[hit->hit.point] : 0.0f;
    update.hit(grid.at(hit->slot)->log_odds[hit->hit.place],
               hitWeight(parameters.voxel_size, deviation));
  });
}

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

namespace {

bool
isNear(const Eigen::Vector3d& point, double voxel_size)
{
  return (point.array().abs() <= kMaxVoxelIndex * voxel_size).all(); // false for NaN
}

Label
labelOf(const BlockReader& reader, const VoxelBlock* block, int place)
{
  return block && reader.isOccupied(*block, place) ? reader.label(*block, place)
                                                   : kUnlabelled;
}

// Where a segment is still before a box, or has just come to it: the last of the walls
// that it comes through to be inside.
struct Entry {
  int axis = 0;
  int slab = 0; ///< voxels from the start along the axis
};

// In 64 bits: a window that lies nowhere is far beyond all voxels.
using WideIndex = Eigen::Matrix<std::int64_t, 3, 1>;

// \param[in] low, high the first and the last voxel of the box
// \return nothing if the segment does not come to it
std::optional<Entry>
entryOf(const QuantizedPoint& from, const QuantizedPoint& to, const WideIndex& low,
        const WideIndex& high)
{
  const WideIndex start = voxelOf(from).cast<std::int64_t>();
  const WideIndex end = voxelOf(to).cast<std::int64_t>();
  Entry entry;
  double latest = 0.0; // in lengths of the segment
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
  const auto reading = lock_.read();
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> blocks;
  grid_.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    if (!block.records.empty())
      blocks.emplace_back(index, &block);
  });
  std::vector<std::size_t> first(blocks.size() + 1, 0);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b)
    first[b + 1] = reader_.countOccupied(*blocks[b].second);
  std::partial_sum(first.begin(), first.end(), first.begin());
  VoxelCloud voxels =
      reader_.makeCloud(first.back(), parameters_.voxel_size, cloud_origin_);
#pragma omp parallel for schedule(dynamic, 64)
  for (std::size_t b = 0; b < blocks.size(); ++b)
    reader_.read(blocks[b].first, *blocks[b].second, first[b], voxels);
  return voxels;
}

VoxelCloud
SemanticVoxelMap::occupiedEverywhere() const
{
  const auto reading = lock_.read();
  std::size_t count = 0;
  visitBlocks([&](const VoxelIndex&, const VoxelBlock& block) {
    count += reader_.countOccupied(block);
  });
  VoxelCloud voxels = reader_.makeCloud(count, parameters_.voxel_size, cloud_origin_);
  std::size_t first = 0;
  visitBlocks([&](const VoxelIndex& index, const VoxelBlock& block) {
    reader_.read(index, block, first, voxels);
    first += reader_.countOccupied(block);
  });
  return voxels;
}

void
SemanticVoxelMap::forEachBlock(const VisitBlock& visit) const
{
  const auto reading = lock_.read();
  visitBlocks(visit);
}

void
SemanticVoxelMap::visitBlocks(const VisitBlock& visit) const
{
  const std::lock_guard<std::mutex> alone(store_reading_);
  // Two ordered lists become one; of a block in both, the window has the newer state.
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> window;
  grid_.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    window.emplace_back(index, &block);
  });
  auto next = window.begin();
  const auto visitWindowBefore = [&](const VoxelIndex& index) {
    for (; next != window.end() && VoxelIndexLess()(next->first, index); ++next)
      visit(next->first, *next->second);
  };
  store_->forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    visitWindowBefore(index);
    if (!grid_.contains(index))
      visit(index, block);
  });
  for (; next != window.end(); ++next)
    visit(next->first, *next->second);
}

VoxelIndex
SemanticVoxelMap::voxelOf(const Eigen::Vector3d& point) const
{
  if (!isNear(point, parameters_.voxel_size))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "a point at " << point.transpose() << " m lies in no voxel");
  return pcl_semantic::voxelOf(quantize(point, parameters_.voxel_size));
}

const VoxelBlock*
SemanticVoxelMap::findVoxel(const Eigen::Vector3d& point, int& place) const
{
  if (!isNear(point, parameters_.voxel_size))
    return nullptr;
  const VoxelIndex voxel = voxelOf(point);
  place = voxelInBlock(voxel);
  return grid_.find(blockOf(voxel));
}

Occupancy
SemanticVoxelMap::occupancy(const Eigen::Vector3d& point) const
{
  const auto reading = lock_.read();
  int place = 0;
  const VoxelBlock* const block = findVoxel(point, place);
  return block ? reader_.occupancy(*block, place) : Occupancy::unknown;
}

Label
SemanticVoxelMap::label(const Eigen::Vector3d& point) const
{
  const auto reading = lock_.read();
  int place = 0;
  const VoxelBlock* const block = findVoxel(point, place);
  return labelOf(reader_, block, place);
}

std::vector<Label>
SemanticVoxelMap::labels(const std::vector<Eigen::Vector3d>& points) const
{
  const auto reading = lock_.read();
  std::vector<Label> labels(points.size());
#pragma omp parallel for schedule(dynamic, 4096)
  for (std::size_t i = 0; i < points.size(); ++i) {
    int place = 0;
    const VoxelBlock* const block = findVoxel(points[i], place);
    labels[i] = labelOf(reader_, block, place);
  }
  return labels;
}

VoxelState
SemanticVoxelMap::state(const Eigen::Vector3d& point) const
{
  const auto reading = lock_.read();
  int place = 0;
  if (const VoxelBlock* const block = findVoxel(point, place))
    return reader_.state(blockOf(voxelOf(point)), *block, place);
  VoxelState unknown = reader_.state(VoxelIndex::Zero(), VoxelBlock(), 0);
  if (isNear(point, parameters_.voxel_size))
    unknown.index = voxelOf(point);
  return unknown;
}

std::vector<VoxelState>
SemanticVoxelMap::states(const Eigen::AlignedBox3d& box) const
{
  const auto reading = lock_.read();
  const double farthest = kMaxVoxelIndex * parameters_.voxel_size;
  std::vector<VoxelState> states;
  if (!(box.min().array() <= box.max().array()).all()) // or NaN
    return states;
  const VoxelIndex low = voxelOf(box.min().cwiseMax(-farthest).cwiseMin(farthest));
  const VoxelIndex high = voxelOf(box.max().cwiseMax(-farthest).cwiseMin(farthest));
  grid_.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    if ((index.array() < blockOf(low).array()).any() ||
        (index.array() > blockOf(high).array()).any())
      return;
    for (int place = 0; place < kBlockVoxels; ++place) {
      const Eigen::Array3i voxel = voxelAt(index, place).array();
      if (block.log_odds[std::size_t(place)] != kUnknown &&
          (voxel >= low.array()).all() && (voxel <= high.array()).all())
        states.push_back(reader_.state(index, block, place));
    }
  });
  return states;
}

std::optional<VoxelState>
SemanticVoxelMap::firstOccupied(const Eigen::Vector3d& from,
                                const Eigen::Vector3d& to) const
{
  const auto reading = lock_.read();
  std::optional<VoxelState> found;
  const double voxel_size = parameters_.voxel_size;
  if (!isNear(from, voxel_size) || !isNear(to, voxel_size))
    return found;
  bool inside = false;
  const auto visit = [&](const VoxelIndex& voxel) {
    if (!grid_.contains(blockOf(voxel)))
      return !inside; // it does not come back
    inside = true;
    const VoxelBlock* const block = grid_.find(blockOf(voxel));
    const int place = voxelInBlock(voxel);
    if (block && reader_.isOccupied(*block, place))
      found = reader_.state(blockOf(voxel), *block, place);
    return !found;
  };
  const QuantizedPoint start = quantize(from, voxel_size),
                       end = quantize(to, voxel_size);
  const WideIndex low = grid_.origin().cast<std::int64_t>() * kBlockEdge;
  const WideIndex high =
      low + grid_.size().cast<std::int64_t>() * kBlockEdge - WideIndex::Ones();
  if (const std::optional<Entry> entry = entryOf(start, end, low, high))
    traverseSegmentFrom(start, end, entry->axis, entry->slab, visit);
  return found;
}

std::size_t
SemanticVoxelMap::memory() const
{
  const auto reading = lock_.read();
  std::size_t bytes = grid_.slots() * sizeof(std::unique_ptr<VoxelBlock>);
  grid_.forEach(
      [&](const VoxelIndex&, const VoxelBlock& block) { bytes += memoryOf(block); });
  return bytes + ray_caster_.memory();
}

Eigen::Vector3d
SemanticVoxelMap::cloudOrigin() const
{
  const auto reading = lock_.read();
  return cloud_origin_;
}

} // namespace pcl_semantic
