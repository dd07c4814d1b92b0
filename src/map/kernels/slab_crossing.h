// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <cstddef>
#include <cstdint>

/** \brief Finds the cells of a slab (a layer of voxels across the longest axis of the
 * rays) that rays from one point cross, on raw pointers. Arrays are padded by
 * `slab_lanes` values.
 *
 * Positions are single precision, in voxels relative to the start voxel. Rays within
 * `margin` of a boundary are undecided and returned to the caller. */
namespace pcl_semantic::kernels {

constexpr std::size_t slab_lanes = 16;

/** \brief A slab and one byte per cell, which is set if a ray crosses the cell (row,
 * column). The bytes of eight slabs are interleaved. */
struct SlabView {
  float row_start, column_start; ///< start of all rays in their first voxel [voxels]
  float enter, leave;            ///< distance of the slab's two sides [voxels]
  float margin;                  ///< [voxels]
  int slab;                      ///< counted from the start
  int first_row, first_column;   ///< of the bytes
  int rows, columns;             ///< extent of the bytes
  int column_stride;             ///< bytes between columns
  int nowhere;                   ///< a byte for all cells outside
  std::uint8_t* cells;           ///< of this slab
};

/** \brief Bundles of rays: the range of their slopes (per voxel along the axis), and
 * the rays at their corners: 0 low row and column, 1 high row, 2 high column, 3 both.
 * In the given slabs they are at most one voxel wide. */
struct BundleView {
  const float *row_low, *row_high, *column_low, *column_high;
  const float *corner_row[4], *corner_column[4];
  const std::int32_t* longest; ///< last slab that any ray reaches
  const std::int32_t* reach;   ///< number of slabs that all rays pass completely
};

/** \brief Rays: slopes, slab of the end, and its cell. */
struct RayView {
  const float *row_slope, *column_slope;
  const std::int32_t *end_slab, *end_row, *end_column;
};

struct RaySlab {
  std::uint32_t ray, slab;
};

struct SlabCrossing {
  /** \brief Sets the cells of bundles that certainly cross one cell, two or three in a
   * line, or certain ones of four around a corner. Returns the number of undecided
   * bundles and lists them. */
  std::size_t (*crossBundles)(const SlabView& slab, const BundleView& bundles,
                              std::size_t count, std::uint32_t* left);

  /** \brief Sets the cells that rays cross. Returns the number of rays that are too
   * close to a boundary and lists them. */
  std::size_t (*crossRays)(const SlabView& slab, const RayView& rays, std::size_t count,
                           std::uint32_t* left);

  /** \brief Does the same for all rays and several consecutive slabs. */
  std::size_t (*crossSlabs)(const SlabView* slabs, std::size_t slab_count,
                            const RayView& rays, std::size_t count, RaySlab* left);
};

const SlabCrossing& slabCrossing(SimdTier tier);

} // namespace pcl_semantic::kernels
