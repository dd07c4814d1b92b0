// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"
#include "crossed_voxels.h"
#include "directed_ray.h"
#include "ray_traversal.h"

#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/scan.h>

#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace kernels {
struct RayBatch;
struct RayStart;
} // namespace kernels

/** \brief An end point of a ray in a block of the window. */
struct RayHit {
  std::uint32_t point;                   ///< its index in the scan
  std::uint16_t offset;                  ///< offset of the voxel, see voxelInBlock()
  std::array<std::uint16_t, 3> position; ///< in the voxel [2^-10 voxel]
};

/** \brief Casts the rays of a scan through a window. Collects the set of the voxels
 * that the rays cross and the set of the voxels that contain an end point. Neither set
 * depends on the order of the points or on the number of threads. */
class RayCaster {
public:
  using Grid = ScrollingVoxelGrid<VoxelBlock>;

  /** \param[in] slots number of slots of the grid, see ScrollingVoxelGrid::slots() */
  explicit RayCaster(std::size_t slots, SimdTier tier = simdTier())
      : tier_(tier), crossed_(slots), first_hit_(slots), hit_count_(slots)
  {}

  struct Settings {
    double voxel_size = 0.0;  ///< [m]
    double max_range = 0.0;   ///< SemanticVoxelMap::Parameters::max_range [m]
    std::vector<bool> is_sky; ///< by label; points with these labels cast no ray
    Clearing clearing = Clearing::full;
  };

  /** \brief Discards the results of the previous scan and casts the rays of a new one.
   */
  ScanCounts cast(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                  const Grid& grid, const Settings& settings);

  /** \brief The end points in the block of a slot, in any order.
   * \return first end point, and one past the last */
  std::pair<const RayHit*, const RayHit*>
  hitsIn(std::size_t slot) const
  {
    const RayHit* const first = hits_.data() + first_hit_[slot];
    return {first, first + hit_count_[slot]};
  }

  /** \brief An end point inside the window. */
  struct SlotHit {
    std::uint32_t slot;
    RayHit hit;
  };

  /** \brief Visits the rays in the order of the points.
   * \param[in] visit called with the start of the ray, the end of its part that clears
   * space, and its SlotHit. The SlotHit is null if the ray has no end point in the
   * window */
  template <typename Visit>
  void
  forEachRay(Visit&& visit) const
  {
    for (const Part& part : parts_) {
      auto hit = part.hits.begin();
      for (const DirectedRay& ray : part.rays) {
        const bool is_hit = hit != part.hits.end() && hit->hit.point == ray.point;
        visit(start_, QuantizedPoint(start_ + ends_[ray.point].cast<std::int64_t>()),
              is_hit ? &*hit : nullptr);
        hit += is_hit;
      }
    }
  }

  /** \brief The voxels that the scan has crossed or hit. */
  const CrossedVoxels&
  crossed() const
  {
    return crossed_;
  }

  /** \brief Memory, including data of the last scan [bytes]. */
  std::size_t memory() const;

private:
  // Results of one thread.
  struct Part {
    std::vector<DirectedRay> rays;
    std::vector<std::uint32_t> next; // by tile: number of rays; sortRays() replaces it
                                     // by the index of the next ray in rays_
    std::vector<SlotHit> hits;
    std::size_t invalid = 0, sky = 0;
  };

  // Finds the voxels that contain an end point within range, and the points that cast a
  // ray.
  void findHits(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                const Settings& settings, std::size_t begin, std::size_t end,
                Part& part);

  // Finds the directions of the rays and the ends of their parts that clear space. All
  // hits must be found before.
  void findRays(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                const Settings& settings, std::size_t begin, std::size_t end,
                Part& part);

  // Moves the rays of a batch to a part.
  void addRays(const kernels::RayStart& start, kernels::RayBatch& batch, Part& part);

  void sortHits();

  std::vector<std::uint32_t> sortRays();

  void crossVoxels();

  SimdTier tier_;
  CrossedVoxels crossed_;
  QuantizedPoint start_ = QuantizedPoint::Zero();
  // By point. After findHits(): the voxel of the point, or no_ray. After findRays():
  // the end of the cleared part of its ray, relative to start_.
  std::vector<RayDelta> ends_;
  std::vector<Part> parts_;                          // reused, to avoid allocations
  std::vector<const DirectedRay*> rays_;             // by tile
  std::vector<RayHit> hits_;                         // by slot
  std::vector<std::uint32_t> first_hit_, hit_count_; // by slot
  std::vector<std::uint32_t> hit_slots_;             // slots with a hit
};

} // namespace pcl_semantic
