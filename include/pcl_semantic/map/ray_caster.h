/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/map/crossed_voxels.h>
#include <pcl_semantic/map/scrolling_voxel_grid.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief What the map needs of a cloud of any type. */
struct Scan {
  std::vector<Eigen::Vector3f> points; ///< sensor frame [m]
  std::vector<std::uint32_t> rgb;      ///< packed as in PCL; empty = no colour
  const LabelDistributions* distributions = nullptr; ///< null = no labels
};

/** \brief Counts of one scan. */
struct ScanCounts {
  std::size_t points = 0;     ///< in the cloud
  std::size_t rays = 0;       ///< cast
  std::size_t invalid = 0;    ///< at NaN, infinite or absurdly far: skipped
  std::size_t sky = 0;        ///< labelled as sky: skipped
  std::size_t hit_voxels = 0; ///< voxels with an end point
};

/** \brief An end point of a ray in a voxel of the window. */
class RayHit {
public:
  static constexpr int kPointBits = 27;
  static constexpr int kPlaceBits = 3 * kBlockBits;

  RayHit(std::size_t slot, int place, std::size_t point)
      : key_((std::uint64_t(slot) << kPlaceBits | std::uint64_t(place)) << kPointBits |
             std::uint64_t(point))
  {}

  std::size_t
  point() const
  {
    return key_ & ((std::uint64_t(1) << kPointBits) - 1);
  }

  /** \brief Equal for hits in the same voxel. */
  std::uint64_t
  voxel() const
  {
    return key_ >> kPointBits;
  }

  std::size_t
  slot() const
  {
    return voxel() >> kPlaceBits;
  }

  int
  place() const
  {
    return static_cast<int>(voxel() & (kBlockVoxels - 1));
  }

  bool
  operator<(const RayHit& other) const
  {
    return key_ < other.key_;
  }

private:
  std::uint64_t key_;
};

/** \brief Casts the rays of a scan through a window and notes which voxels were hit and
 * which were crossed: as sets, so that neither the order of the points nor the number
 * of threads matters. */
class RayCaster {
public:
  using Grid = ScrollingVoxelGrid<VoxelBlock>;

  /** \param[in] slots of the grid it will be used on */
  explicit RayCaster(std::size_t slots) : crossed_(slots) {}

  struct Settings {
    double voxel_size = 0.0;  ///< [m]
    double max_range = 0.0;   ///< SemanticVoxelMap::Parameters::max_range [m]
    std::vector<bool> is_sky; ///< by label; these pixels cast no ray
  };

  /** \brief Forgets the last scan and casts the rays of this one. */
  ScanCounts cast(const Scan& scan, const Eigen::Isometry3d& T_world_sensor,
                  const Grid& grid, const Settings& settings);

  /** \brief End points inside the window, ordered by voxel. */
  const std::vector<RayHit>&
  hits() const
  {
    return hits_;
  }

  /** \brief The voxels that a ray crossed, its end point included. */
  const CrossedVoxels&
  crossed() const
  {
    return crossed_;
  }

private:
  CrossedVoxels crossed_;
  std::vector<RayHit> hits_;
};

} // namespace pcl_semantic
