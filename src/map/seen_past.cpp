// SPDX-License-Identifier: BSD-3-Clause
#include "seen_past.h"
#include "block_reader.h"
#include "class_flags.h"
#include "core/parallel_guard.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr double kLeastDistance = 1.0; ///< of the end of a ray behind a voxel [m]
constexpr double kDeviations = 3.0;    ///< likewise, of its depth
constexpr std::uint32_t kLeastRays = 2;

// An occupied voxel of a dynamic class.
struct Candidate {
  VoxelIndex voxel;
  std::size_t slot;
  int offset;
  Label label;
};

Label
labelOf(const Scan& scan, std::size_t point)
{
  return scan.distributions ? scan.distributions->mapLabel(Eigen::Index(point))
                            : kUnlabelled;
}

// The hits in a block, and those on one class in and around it.
class HitsAround {
public:
  HitsAround(Label label, const VoxelIndex& block, const Scan& scan,
             const RayCaster& caster, const RayCaster::Grid& grid)
      : label_(label), scan_(scan)
  {
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const VoxelIndex step(x, y, z);
          if (grid.contains(block + step))
            add(step, caster.hitsIn(grid.slotOf(block + step)));
        }
  }

  /** \brief Whether a ray ends in a voxel, or in one of its 26 neighbours on the class
   * or without one. */
  bool
  hold(int offset) const
  {
    if (inside_[std::size_t(offset)])
      return true;
    const VoxelIndex voxel = voxelAt(VoxelIndex::Zero(), offset);
    for (int z = 0; z < 3; ++z)
      for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 3; ++x)
          if (on_class_[bitOf(voxel + VoxelIndex(x, y, z))])
            return true;
    return false;
  }

private:
  static constexpr int kEdge = kBlockEdge + 2; // one voxel on each side

  static std::size_t
  bitOf(const VoxelIndex& place)
  {
    return std::size_t((place.z() * kEdge + place.y()) * kEdge + place.x());
  }

  void
  add(const VoxelIndex& step, const std::pair<const RayHit*, const RayHit*>& hits)
  {
    for (const RayHit* hit = hits.first; hit != hits.second; ++hit) {
      if (step.isZero())
        inside_.set(hit->offset);
      const Label label = labelOf(scan_, hit->point);
      if (label != label_ && label != kUnlabelled)
        continue;
      const VoxelIndex place = voxelAt(step, hit->offset) + VoxelIndex::Ones();
      if ((place.array() >= 0).all() && (place.array() < kEdge).all())
        on_class_.set(bitOf(place));
    }
  }

  Label label_;
  const Scan& scan_;
  std::bitset<kBlockVoxels> inside_;
  std::bitset<kEdge * kEdge * kEdge> on_class_;
};

// A voxel whose depth is less certain is not judged.
bool
isCertain(const VoxelIndex& voxel, const Scan& scan, const Eigen::Vector3d& sensor,
          double voxel_size)
{
  const double squared_distance = (centreOf(voxel, voxel_size) - sensor).squaredNorm();
  return kDeviations * scan.depth_error * squared_distance <= kLeastDistance;
}

// The candidates that no hit holds, by slot and offset.
std::vector<Candidate>
findCandidates(const ClassFlags& dynamic, int classes, const BlockReader& reader,
               const Scan& scan, const Eigen::Vector3d& sensor, double voxel_size,
               const RayCaster& caster, const RayCaster::Grid& grid)
{
  struct Place {
    VoxelIndex index;
    const VoxelBlock* block;
  };
  std::vector<Place> places;
  grid.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    if (!block.records.empty())
      places.push_back({index, &block});
  });
  std::vector<std::vector<Candidate>> found(places.size());
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 256)
  for (std::size_t p = 0; p < places.size(); ++p)
    guard.run([&] {
      const VoxelIndex& index = places[p].index; // clang 14 captures no bindings
      const VoxelBlock* const block = places[p].block;
      std::vector<Candidate>& here = found[p];
      for (int offset = 0; offset < kBlockVoxels; ++offset)
        if (reader.isOccupied(*block, offset)) {
          const VoxelIndex voxel = voxelAt(index, offset);
          if (!isCertain(voxel, scan, sensor, voxel_size))
            continue;
          // A CRF must not change the occupancy of a map.
          const Label label = measuredLabel(*block, offset, classes);
          if (dynamic[label])
            here.push_back({voxel, grid.slotOf(index), offset, label});
        }
      std::optional<HitsAround> hits; // of the class before
      Label hits_label = kUnlabelled;
      const auto isHeld = [&](const Candidate& each) {
        if (!hits || hits_label != each.label)
          hits.emplace(each.label, index, scan, caster, grid);
        hits_label = each.label;
        return hits->hold(each.offset);
      };
      here.erase(std::remove_if(here.begin(), here.end(), isHeld), here.end());
    });
  guard.rethrow();
  std::vector<Candidate> all;
  for (const std::vector<Candidate>& here : found)
    all.insert(all.end(), here.begin(), here.end());
  return all;
}

// Bins of directions: the faces of a cube around the sensor, each a square of bins.
class DirectionBins {
public:
  static constexpr int kBins = 192; ///< along an edge; 0.6 degrees in the middle

  /** \brief The bin of a direction, which is not zero. */
  static std::size_t
  binOf(const Eigen::Vector3d& direction)
  {
    int axis = 0;
    direction.cwiseAbs().maxCoeff(&axis);
    const double scale = 1.0 / std::abs(direction[axis]);
    const int face = 2 * axis + (direction[axis] < 0.0);
    return place(face, cell(direction[(axis + 1) % 3] * scale),
                 cell(direction[(axis + 2) % 3] * scale));
  }

  /** \brief Visits the bins that a box touches, and perhaps some beside it.
   * \param[in] corner, edge of the box, relative to the sensor, which is outside */
  template <typename Visit>
  static void
  forEachBin(const Eigen::Vector3d& corner, double edge, Visit&& visit)
  {
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {1.0, -1.0}) {
        const double near = sign > 0.0 ? corner[axis] : -(corner[axis] + edge);
        const double far = near + edge;
        if (far <= 0.0)
          continue;
        const int face = 2 * axis + (sign < 0.0);
        const auto [u0, u1] = range(corner[(axis + 1) % 3], edge, near, far);
        const auto [v0, v1] = range(corner[(axis + 2) % 3], edge, near, far);
        for (int v = v0; v <= v1; ++v)
          for (int u = u0; u <= u1; ++u)
            visit(place(face, u, v));
      }
  }

  static constexpr std::size_t kSize = std::size_t(6) * kBins * kBins;

private:
  static std::size_t
  place(int face, int u, int v)
  {
    return (std::size_t(face) * kBins + std::size_t(v)) * kBins + std::size_t(u);
  }

  static int
  cell(double slope)
  {
    return std::clamp(int((slope + 1.0) * 0.5 * kBins), 0, kBins - 1);
  }

  // Cells of the slopes that an interval has between two distances; empty beyond a
  // face.
  static std::pair<int, int>
  range(double low, double edge, double near, double far)
  {
    const double high = low + edge;
    const double nearest = std::max(near, 1e-3 * edge);
    const double least = low / (low < 0.0 ? nearest : far);
    const double most = high / (high > 0.0 ? nearest : far);
    if (least > 1.0 || most < -1.0)
      return {0, -1};
    return {cell(std::max(least, -1.0)), cell(std::min(most, 1.0))};
  }
};

// The candidates by the bins that they touch.
class CandidateBins {
public:
  CandidateBins(const std::vector<Candidate>& candidates, const Eigen::Vector3d& sensor,
                double voxel_size)
      : first_(DirectionBins::kSize + 1, 0)
  {
    const auto forEach = [&](auto&& visit) {
      for (std::size_t c = 0; c < candidates.size(); ++c)
        DirectionBins::forEachBin(
            candidates[c].voxel.cast<double>() * voxel_size - sensor, voxel_size,
            [&](std::size_t bin) { visit(bin, std::uint32_t(c)); });
    };
    forEach([&](std::size_t bin, std::uint32_t) { ++first_[bin + 1]; });
    for (std::size_t bin = 0; bin < DirectionBins::kSize; ++bin)
      first_[bin + 1] += first_[bin];
    members_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    forEach([&](std::size_t bin, std::uint32_t c) { members_[next[bin]++] = c; });
  }

  std::pair<const std::uint32_t*, const std::uint32_t*>
  in(std::size_t bin) const
  {
    return {members_.data() + first_[bin], members_.data() + first_[bin + 1]};
  }

private:
  std::vector<std::uint32_t> first_, members_;
};

// The distance at which a ray of unit direction leaves a box; negative if it misses it.
double
exitOf(const Eigen::Vector3d& corner, double edge, const Eigen::Vector3d& direction)
{
  double entry = 0.0, exit = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (corner[axis] > 0.0 || corner[axis] + edge < 0.0)
        return -1.0;
      continue;
    }
    const double a = corner[axis] / direction[axis];
    const double b = (corner[axis] + edge) / direction[axis];
    entry = std::max(entry, std::min(a, b));
    exit = std::min(exit, std::max(a, b));
  }
  return entry < exit ? exit : -1.0;
}

// Minimum distance of the end of a ray behind a voxel [m].
double
marginOf(const Scan& scan, std::size_t point, const Eigen::Vector3f& position)
{
  double deviation = scan.depth_error * double(position.squaredNorm());
  if (scan.deviations)
    deviation = std::max(deviation, double((*scan.deviations)[point]));
  return std::max(kLeastDistance, kDeviations * deviation);
}

// The rays past each candidate, at most kLeastRays.
std::vector<std::uint32_t>
countRays(const std::vector<Candidate>& candidates, const Scan& scan,
          const Eigen::Isometry3d& T_world_sensor, double voxel_size,
          const ClassFlags& sky)
{
  const CandidateBins bins(candidates, T_world_sensor.translation(), voxel_size);
  std::vector<std::uint32_t> rays(candidates.size(), 0);
  const std::size_t points = scan.points.size();
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector3f position = scan.points[i];
    const double length = position.cast<double>().norm();
    if (!(length > 0.0 && length < 1e6)) // or NaN
      continue;
    const Eigen::Vector3d direction =
        T_world_sensor.linear() * position.cast<double>() / length;
    const auto [first, last] = bins.in(DirectionBins::binOf(direction));
    if (first == last)
      continue;
    const Label label = labelOf(scan, i);
    if (sky[label])
      continue;
    const double farthest = length - marginOf(scan, i, position);
    for (const std::uint32_t* c = first; c != last; ++c) {
      if (candidates[*c].label == label)
        continue;
      const double exit = exitOf(candidates[*c].voxel.cast<double>() * voxel_size -
                                     T_world_sensor.translation(),
                                 voxel_size, direction);
      if (exit >= 0.0 && exit <= farthest &&
          __atomic_load_n(&rays[*c], __ATOMIC_RELAXED) < kLeastRays)
        __atomic_fetch_add(&rays[*c], 1, __ATOMIC_RELAXED);
    }
  }
  return rays;
}

} // namespace

std::size_t
freeSeenPast(const LabelSet& label_set, const MapParameters& parameters,
             const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
             const RayCaster& caster, RayCaster::Grid& grid)
{
  const ClassFlags dynamic = classesWith(&LabelClass::dynamic, label_set);
  if (std::count(dynamic.begin(), dynamic.end(), true) == 0)
    return 0;
  const int classes = label_set.size();
  const BlockReader reader(classes, parameters);
  const std::vector<Candidate> candidates =
      findCandidates(dynamic, classes, reader, scan, T_world_sensor.translation(),
                     parameters.voxel_size, caster, grid);
  if (candidates.empty())
    return 0;
  const std::vector<std::uint32_t> rays =
      countRays(candidates, scan, T_world_sensor, parameters.voxel_size,
                classesWith(&LabelClass::sky, label_set));
  const OccupancyUpdate occupancy(parameters.fusion);
  std::size_t freed = 0;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    if (rays[c] < kLeastRays)
      continue;
    freeVoxel(*grid.at(candidates[c].slot), candidates[c].offset, classes, occupancy);
    ++freed;
  }
  return freed;
}

} // namespace pcl_semantic
