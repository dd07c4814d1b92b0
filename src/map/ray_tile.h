/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "kernels/slab_crossing.h"

#include <pcl_semantic/map/directed_ray.h>

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Rays of neighbouring directions. */
struct RayBundle {
  float row_low, row_high, column_low, column_high; ///< range of the slopes
  float corner_row[4], corner_column[4];            ///< see kernels::BundleView
  std::int32_t reach;       ///< slabs that all these rays pass whole
  std::int32_t longest;     ///< largest end_slab
  std::uint32_t begin, end; ///< its parts: smaller bundles, or rays
};

/** \brief The rays of one tile, ordered by leaf, and their bundles of several sizes. */
class RayTile {
public:
  static constexpr int kLevels = kLeafBits + 1; ///< of bundles

  /** \brief Range of slopes of the bundles of a level. */
  static float
  widthOf(int level)
  {
    return float(1 << level) / float(1 << (kTileBits + kLeafBits - 1));
  }

  /** \brief Takes the rays of a tile, in any order; there is at least one. */
  void set(const DirectedRay* const* rays, std::size_t count);

  /** \brief The parts of level 0 are rays, those of level l are bundles of l - 1. */
  const std::vector<RayBundle>&
  bundles(int level) const
  {
    return levels_[std::size_t(level)];
  }

  /** \brief The bundle of all rays. */
  const RayBundle&
  all() const
  {
    return levels_.back().front();
  }

  std::size_t
  size() const
  {
    return count_;
  }

  /** \brief Number of a ray in the scan. */
  std::uint32_t
  point(std::size_t ray) const
  {
    return point_[ray];
  }

  kernels::RayView view() const;

  /** \brief Removes the rays that end before a slab; the parts of the bundles of level
   * 0 do not hold any more. */
  void removeEnded(int slab);

private:
  void sortByLeaf(const DirectedRay* const* rays, std::size_t count);

  void makeLevels();

  std::size_t count_ = 0; // the arrays have kernels::slab_lanes more
  std::vector<float> row_slope_, column_slope_;
  std::vector<std::int32_t> end_slab_, end_row_, end_column_;
  std::vector<std::uint32_t> point_;
  std::vector<std::uint16_t> leaf_;
  std::array<std::vector<RayBundle>, kLevels> levels_;
};

} // namespace pcl_semantic
