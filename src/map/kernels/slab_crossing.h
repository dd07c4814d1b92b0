// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Which cells of a slab (a layer of voxels across the axis along which the rays
 * are longest) are crossed by rays from one point: raw pointers and sizes only. Arrays
 * have `slab_lanes` values more than there are entries.
 *
 * Positions are single precision, in voxels from the voxel of the start. What lies
 * within `margin` of a boundary is not decided here but given back. */
namespace pcl_semantic::kernels {

constexpr std::size_t slab_lanes = 16;

/** \brief A slab and the bytes that stand for its cells: that of cell (row, column) is
 * set if a ray crosses it. The bytes of eight slabs lie side by side. */
struct SlabView {
  float row_start, column_start; ///< of all rays, in their first voxel [voxels]
  float enter, leave;            ///< distance of the slab's two sides [voxels]
  float margin;                  ///< [voxels]
  int slab;                      ///< number, counted from the start
  int first_row, first_column;   ///< of the bytes
  int rows, columns;             ///< extent of the bytes
  int column_stride;             ///< bytes from one column to the next
  int nowhere;                   ///< a byte for what lies outside
  std::uint8_t* cells;           ///< of this slab
};

/** \brief Bundles of rays: the range of their slopes (per voxel along the axis), and
 * the rays at their corners: 0 low row and column, 1 high row, 2 high column, 3 both.
 * In the slabs looked at they are no wider than a voxel.
 */
struct BundleView {
  const float *row_low, *row_high, *column_low, *column_high;
  const float *corner_row[4], *corner_column[4];
  const std::int32_t* longest; ///< slab that none of their rays goes beyond
  const std::int32_t* reach;   ///< slabs that all the rays above pass whole
};

/** \brief Rays: slopes, number of the slab they end in, and the cell there. */
struct RayView {
  const float *row_slope, *column_slope;
  const std::int32_t *end_slab, *end_row, *end_column;
};

struct RaySlab {
  std::uint32_t ray, slab;
};

struct SlabCrossing {
  /** \brief Sets the cells of bundles that certainly cross one cell, two or three in a
   * line, or certain ones of four that share a corner, and no other; gives the number
   * of those that are left, and lists them. */
  std::size_t (*crossBundles)(const SlabView& slab, const BundleView& bundles,
                              std::size_t count, std::uint32_t* left);

  /** \brief Sets the cells that rays cross; gives the number of rays that are too close
   * to a boundary, and lists them. */
  std::size_t (*crossRays)(const SlabView& slab, const RayView& rays, std::size_t count,
                           std::uint32_t* left);

  /** \brief The same for all rays and several slabs, one behind the other. */
  std::size_t (*crossSlabs)(const SlabView* slabs, std::size_t slab_count,
                            const RayView& rays, std::size_t count, RaySlab* left);
};

const SlabCrossing& slabCrossing(SimdTier tier);

} // namespace pcl_semantic::kernels
