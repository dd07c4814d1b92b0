// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/slab_crossing.h"
#include "ray_table.h"

#include <pcl_semantic/map/directed_ray.h>

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Rays: row and column slope, and the numbers of DirectedRay. */
using RayRows = RayTable<2, 4>;
enum RayNumber : std::size_t { kEndSlab, kEndRow, kEndColumn, kPoint };

/** \brief Bundles of rays of neighbouring directions: the slopes of kernels::BundleView
 * in its order, its numbers, and the range of their parts: smaller bundles, or rays. */
using BundleRows = RayTable<12, 4>;
enum BundleNumber : std::size_t { kLongest, kReach, kBegin, kEnd };

kernels::RayView columnsOf(const RayRows& rays);

kernels::BundleView columnsOf(const BundleRows& bundles);

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
  const BundleRows&
  bundles(int level) const
  {
    return levels_[std::size_t(level)];
  }

  /** \brief The one bundle of all rays. */
  const BundleRows&
  all() const
  {
    return levels_.back();
  }

  const RayRows&
  rays() const
  {
    return rays_;
  }

  /** \brief Removes the rays that end before a slab; the parts of the bundles of level
   * 0 do not hold any more. */
  void
  removeEnded(int slab)
  {
    rays_.removeEnded(slab);
  }

private:
  // The outermost of some rays in eight directions: low and high row, low and high
  // column, and the four corners.
  struct Outermost {
    static constexpr std::size_t directions = 8;

    std::array<float, directions> outward; // how far they go
    std::array<float, directions> row_slope, column_slope;
    std::array<std::int32_t, directions> end_slab;
    std::int32_t longest;

    void take(const Outermost& other);
  };

  Outermost outermostOf(std::size_t ray) const;

  void sortByLeaf(const DirectedRay* const* rays, std::size_t count);

  void makeLevels();

  static void addTo(BundleRows& level, const Outermost& rays, std::size_t begin,
                    std::size_t end);

  RayRows rays_;
  std::array<BundleRows, kLevels> levels_;
  std::vector<std::uint16_t> leaf_;  // of the parts of a level
  std::vector<Outermost> outermost_; // of their rays
};

} // namespace pcl_semantic
