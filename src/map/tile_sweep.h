// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"
#include "crossed_voxels.h"
#include "directed_ray.h"
#include "kernels/slab_crossing.h"
#include "ray_traversal.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pcl_semantic {

/** \brief Rays or bundles of rays as a struct of arrays, for vectorised loops. The
 * first column of numbers is the last slab that any ray of a row reaches. A slab is a
 * layer of voxels across the longest axis of the rays. */
template <std::size_t Slopes, std::size_t Numbers> struct RayTable {
  std::array<std::vector<float>, Slopes> slopes;
  std::array<std::vector<std::int32_t>, Numbers> numbers;
  std::size_t count = 0; ///< number of rows; the columns have kernels::slab_lanes more

  /** \brief Reserves capacity for a total number of rows. */
  void
  reserve(std::size_t rows)
  {
    // The last column grows last: after std::bad_alloc, it shows that growth failed.
    if (numbers.back().size() >= rows + kernels::slab_lanes)
      return;
    forEachColumn([&](auto& column) { column.resize(2 * rows + kernels::slab_lanes); });
  }

  /** \brief Appends rows of another table, within the capacity. */
  void
  add(const RayTable& from, std::size_t begin, std::size_t end)
  {
    constexpr std::size_t step = 4; // values copied beyond the end are ignored
    for (std::size_t i = begin; i < end; i += step) {
      const std::size_t to = count + (i - begin);
      for (std::size_t c = 0; c < Slopes; ++c)
        std::memcpy(&slopes[c][to], &from.slopes[c][i], step * sizeof(float));
      for (std::size_t c = 0; c < Numbers; ++c)
        std::memcpy(&numbers[c][to], &from.numbers[c][i], step * sizeof(std::int32_t));
    }
    count += end - begin;
  }

  /** \brief Removes the rows whose rays all end before a slab. */
  void
  removeEnded(int slab)
  {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const bool keep = numbers[0][i] >= slab;
      forEachColumn([&](auto& column) { column[kept] = column[i]; });
      kept += keep;
    }
    count = kept;
  }

private:
  template <typename Do>
  void
  forEachColumn(Do&& apply)
  {
    for (auto& column : slopes)
      apply(column);
    for (auto& column : numbers)
      apply(column);
  }
};

/** \brief Rays: row and column slope, and the numbers of DirectedRay. */
using RayRows = RayTable<2, 4>;
enum RaySlope : std::size_t { kRowSlope, kColumnSlope };
enum RayNumber : std::size_t { kEndSlab, kEndRow, kEndColumn, kPoint };

/** \brief Bundles of rays of similar directions. The columns are those of
 * kernels::BundleView in its order, then the range of the bundle's parts, which are
 * smaller bundles or rays. */
using BundleRows = RayTable<12, 4>;
enum BundleSlope : std::size_t {
  kRowLow,
  kRowHigh,
  kColumnLow,
  kColumnHigh,
  kCornerRow,                     ///< first of four corners
  kCornerColumn = kCornerRow + 4, ///< likewise
};
enum BundleNumber : std::size_t { kLongest, kReach, kBegin, kEnd };

kernels::RayView columnsOf(const RayRows& rays);

kernels::BundleView columnsOf(const BundleRows& bundles);

/** \brief The rays of one tile, ordered by leaf (DirectedRay::leaf, a small range of
 * directions), and their bundles of several sizes. */
class RayTile {
public:
  static constexpr int kLevels = kLeafBits + 1; ///< number of sizes of bundles

  /** \brief Largest difference of slopes within a bundle of a level. */
  static float
  widthOf(int level)
  {
    return float(1 << level) / float(1 << (kTileBits + kLeafBits - 1));
  }

  /** \brief Sets the rays of a tile, in any order; at least one. */
  void set(const DirectedRay* const* rays, std::size_t count);

  /** \brief The bundles of a level. Parts of level 0 are rays, those of level l are
   * bundles of level l - 1. */
  const BundleRows&
  bundles(int level) const
  {
    return levels_[std::size_t(level)];
  }

  /** \brief The bundle of all rays. */
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

  /** \brief Removes the rays that end before a slab. The parts of the bundles of level
   * 0 become invalid. */
  void
  removeEnded(int slab)
  {
    rays_.removeEnded(slab);
  }

private:
  // The extreme rays in eight directions: low and high row, low and high column, and
  // the four corners.
  struct Outermost {
    static constexpr std::size_t directions = 8;

    std::array<float, directions> outward; // their extent in each direction
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
  std::vector<std::uint16_t> leaf_;  // leaf of each part, for makeLevels()
  std::vector<Outermost> outermost_; // outermost rays of each part, likewise
};

/** \brief The axes of a face, the set of rays that are longest along one axis in one
 * direction. Rows and columns of cells (voxels of a slab) are along the other two
 * axes. */
struct FaceAxes {
  int along, row, column; ///< 0, 1 or 2
  int step;               ///< 1 or -1: direction along the axis

  /** \param[in] face 0..5: 2 axis, plus 1 for its negative direction */
  explicit FaceAxes(int face);
};

/** \brief One byte per cell for up to eight slabs, those in one layer of blocks.
 * Setting bytes is cheap; flush() converts them to bits of CrossedVoxels. */
class SlabBuffer {
public:
  /** \brief Range of cells relative to the start voxel; inside the window. */
  struct Extent {
    int first_row, last_row, first_column, last_column;
  };

  /** \param[in] start voxel in which all rays start */
  void begin(const VoxelIndex& start, const FaceAxes& axes, const Extent& extent);

  /** \brief Completes a view with the bytes of a slab.
   * \param[in] layer of the slab in its block, 0..7 */
  void show(int layer, kernels::SlabView& slab);

  /** \brief Moves the set cells to the crossed voxels.
   * \param[in] block_along block index of the slabs along the axis */
  void flush(int block_along, CrossedVoxels& crossed);

private:
  void flushLine(const std::uint8_t* line, std::size_t slot, int column,
                 CrossedVoxels& crossed) const;

  std::vector<std::uint8_t> cells_; // by column, row and layer
  FaceAxes axes_{0};
  VoxelIndex corner_ = VoxelIndex::Zero(); // voxel of the first row and column
  int first_row_ = 0, first_column_ = 0;   // relative to the start voxel
  int lines_ = 0, columns_ = 0;            // number of lines (eight rows each) and
                                           // columns
};

/** \brief Finds the voxels that the rays of a tile cross: the same set as traversing
 * each ray, but many rays at a time.
 *
 * Proceeds outward slab by slab (layers of voxels across the longest axis of the rays).
 * Near the start a bundle of rays is narrower than a voxel. Where its outermost rays
 * determine the voxels that it crosses, these are set. Undecided bundles are split,
 * finally into rays. Rays that single precision cannot decide are traversed exactly. */
class TileSweep {
public:
  /** \param[in] start of all rays
   * \param[in] ends of all rays of the scan relative to it, by point */
  TileSweep(SimdTier tier, const QuantizedPoint& start,
            const std::vector<RayDelta>& ends, CrossedVoxels& crossed);

  /** \brief Adds the voxels of the window that the rays of a tile cross.
   * \param[in] face 0..5, see FaceAxes */
  void run(int face, const DirectedRay* const* rays, std::size_t count);

private:
  // Slabs of one layer of blocks: first to last, outward.
  struct Group {
    int first, last;
    int block; // along the axis
  };

  bool beginGroup(const Group& group);

  float enterDistance(int slab) const;

  kernels::SlabView viewOf(int number);

  void crossAllRays(const Group& group);

  void crossBundles(const kernels::SlabView& slab, const BundleRows& bundles,
                    int level);

  void crossRays(const kernels::SlabView& slab, const BundleRows& bundles,
                 std::size_t count);

  void crossExactly(std::uint32_t point, int slab);

  const kernels::SlabCrossing& loops_;
  const QuantizedPoint start_;
  const VoxelIndex start_voxel_;
  const std::vector<RayDelta>& ends_;
  CrossedVoxels& crossed_;
  FaceAxes axes_{0};
  float to_first_side_ = 0.0f; // from the start, along the axis [voxels]
  RayTile tile_;
  SlabBuffer buffer_;
  int level_ = 0;     // of the bundles of a group; -1: rays
  int groups_ = 0;    // number of started groups
  BundleRows active_; // of the group
  std::array<BundleRows, RayTile::kLevels> parts_; // parts of undecided bundles of a
                                                   // level, for the current slab
  RayRows rays_;                                   // likewise, of level 0
  std::vector<std::uint32_t> left_;                // undecided rays or bundles
  std::vector<kernels::RaySlab> undecided_;
};

} // namespace pcl_semantic
