// SPDX-License-Identifier: BSD-3-Clause
#include "slab_crossing.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "map/kernels/slab_crossing.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, slab_lanes>;
using IntTag = hn::RebindToSigned<FloatTag>;
using WordTag = hn::RebindToUnsigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;
using Mask = hn::Mask<IntTag>; // for all value types
constexpr std::size_t lanes = hn::MaxLanes(FloatTag());

HWY_INLINE Floats
set(float value)
{
  return hn::Set(FloatTag(), value);
}

HWY_INLINE Ints
set(std::int32_t value)
{
  return hn::Set(IntTag(), value);
}

HWY_INLINE Floats
load(const float* from)
{
  return hn::LoadU(FloatTag(), from);
}

HWY_INLINE Ints
load(const std::int32_t* from)
{
  return hn::LoadU(IntTag(), from);
}

HWY_INLINE Floats
asFloats(Ints values)
{
  return hn::ConvertTo(FloatTag(), values);
}

template <typename V, typename W>
HWY_INLINE Mask
greater(V a, W b)
{
  return hn::RebindMask(IntTag(), hn::Gt(a, b));
}

// a * b + c, never fused.
HWY_INLINE Floats
sumOf(Floats a, Floats b, Floats c)
{
  return hn::Add(hn::Mul(a, b), c);
}

template <typename... Masks>
HWY_INLINE Mask
all(Mask first, Masks... others)
{
  ((first = hn::And(first, others)), ...);
  return first;
}

HWY_INLINE bool
any(Mask wanted)
{
  return !hn::AllFalse(IntTag(), wanted);
}

HWY_INLINE unsigned
bitsOf(Mask wanted)
{
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(IntTag(), wanted, bytes);
  return unsigned(bytes[0] | bytes[1] << 8);
}

// Cells of positions, and the distance of these from the cell's middle (as bits, which
// have the same order).
struct Cells {
  Ints cell, off;
};

HWY_INLINE Cells
cellsOf(Floats position)
{
  const Floats magic = set(12582912.0f); // 1.5 * 2^23: adding it rounds to an integer
  const Floats centred = hn::Sub(position, set(0.5f));
  const Floats rounded = hn::Add(centred, magic);
  const Floats from_centre = hn::Sub(centred, hn::Sub(rounded, magic));
  return {hn::Sub(hn::BitCast(IntTag(), rounded), set(0x4B400000)),
          hn::BitCast(IntTag(), hn::Abs(from_centre))};
}

// Whether cells are certain for positions at this distance from the middle.
HWY_INLINE Mask
isSure(const SlabView& slab, Ints off)
{
  return greater(hn::BitCast(IntTag(), set(0.5f - slab.margin)), off);
}

// Adds a row or column to an offset in the bytes; outside the extent: -1.
HWY_INLINE Ints
offsetOf(Ints number, int extent, Ints offset)
{
  const auto inside = greater(hn::Set(WordTag(), std::uint32_t(extent)),
                              hn::BitCast(WordTag(), number));
  return hn::IfThenElse(inside, offset, set(-1));
}

HWY_INLINE Ints
rowOffset(const SlabView& slab, Ints row)
{
  const Ints r = hn::Sub(row, set(slab.first_row));
  return offsetOf(r, slab.rows, hn::ShiftLeft<3>(r));
}

HWY_INLINE Ints
columnOffset(const SlabView& slab, Ints column)
{
  const Ints c = hn::Sub(column, set(slab.first_column));
  return offsetOf(c, slab.columns, hn::Mul(c, set(slab.column_stride)));
}

// Sets the bytes of the wanted cells, through memory: extracting vector lanes one by
// one would be slower than everything else.
HWY_INLINE void
setCells(const SlabView& slab, Ints offsets, Mask wanted)
{
  HWY_ALIGN std::int32_t stored[lanes];
  hn::Store(hn::IfThenElse(wanted, offsets, set(slab.nowhere)), IntTag(), stored);
  const volatile std::int32_t* const offset = stored;
  for (std::size_t k = 0; k < lanes; ++k)
    slab.cells[std::uint32_t(offset[k])] = 1;
}

HWY_INLINE void
setCellsInside(const SlabView& slab, Ints row, Ints column, Mask wanted)
{
  setCells(slab, hn::Add(row, column),
           all(wanted, greater(hn::Or(row, column), set(-1))));
}

HWY_INLINE std::size_t
list(Mask wanted, std::size_t first, std::uint32_t* to)
{
  std::size_t count = 0;
  for (unsigned bits = bitsOf(wanted); bits != 0; bits &= bits - 1)
    to[count++] = std::uint32_t(first) + unsigned(__builtin_ctz(bits));
  return count;
}

// Four cells around a corner, numbered as the rays at the corners of a bundle. crossed:
// a ray of the bundle is in the cell when it enters or leaves the slab. certain: for
// all four cells, either this holds or no ray crosses the cell.
struct Quadrants {
  Mask crossed[4], certain;
};

HWY_INLINE Quadrants
quadrantsOf(const SlabView& slab, const BundleView& bundles, std::size_t i,
            Ints row_boundary, Ints column_boundary, Mask wanted)
{
  const Floats row = hn::Sub(set(slab.row_start), asFloats(row_boundary));
  const Floats column = hn::Sub(set(slab.column_start), asFloats(column_boundary));
  const Floats enter = set(slab.enter), leave = set(slab.leave);
  const Floats margin = set(slab.margin), margins = set(2.0f * slab.margin);
  Quadrants quadrants;
  quadrants.certain = wanted;
  for (int corner = 0; corner < 4; ++corner) {
    // Beyond the boundary on the side of the corner: positive.
    const Floats row_side = set(corner & 1 ? 1.0f : -1.0f);
    const Floats column_side = set(corner & 2 ? 1.0f : -1.0f);
    const Floats u = hn::Mul(load(bundles.corner_row[corner] + i), row_side);
    const Floats v = hn::Mul(load(bundles.corner_column[corner] + i), column_side);
    const Floats row_start = hn::Mul(row, row_side);
    const Floats column_start = hn::Mul(column, column_side);
    const Floats row_enter = sumOf(u, enter, row_start);
    const Floats row_leave = sumOf(u, leave, row_start);
    const Floats column_enter = sumOf(v, enter, column_start);
    const Floats column_leave = sumOf(v, leave, column_start);
    const Mask row_before = greater(row_enter, margin),
               row_behind = greater(row_leave, margin);
    const Mask column_before = greater(column_enter, margin),
               column_behind = greater(column_leave, margin);
    // A ray passes through the cell if it crosses one boundary before it returns over
    // the other.
    const Floats order = hn::Sub(hn::Mul(u, column_start), hn::Mul(v, row_start));
    const Mask row_last = all(column_before, greater(order, margins));
    const Mask column_last = all(column_behind, greater(hn::Neg(margins), order));
    quadrants.crossed[corner] =
        hn::Or(all(row_before, hn::Or(column_before, column_last)),
               all(row_behind, hn::Or(column_behind, row_last)));
    // The sum of both is linear along a ray, so no other ray reaches a larger value.
    const Mask empty = all(greater(hn::Neg(margins), hn::Add(row_enter, column_enter)),
                           greater(hn::Neg(margins), hn::Add(row_leave, column_leave)));
    quadrants.certain =
        all(quadrants.certain, hn::Or(quadrants.crossed[corner], empty));
  }
  return quadrants;
}

// Decided bundles, and whether they cross the first and the last cell.
struct Decided {
  Mask known, low, high;
};

// Sets the middle one of three cells in a line. Returns the bundles that cross three
// cells: they are at most one cell wide, so they cannot miss it.
HWY_INLINE Mask
crossLines(const SlabView& slab, Ints first, Mask sure, Ints row_extent,
           Ints column_extent)
{
  const Ints none = set(0), two = set(2);
  const Mask by_row = all(hn::Eq(row_extent, two), hn::Eq(column_extent, none));
  const Mask by_column = all(hn::Eq(row_extent, none), hn::Eq(column_extent, two));
  const Mask three = all(sure, hn::Or(by_row, by_column));
  if (any(three))
    setCells(slab,
             hn::Add(first, hn::IfThenElse(by_row, set(8), set(slab.column_stride))),
             three);
  return three;
}

HWY_INLINE void
crossCorners(const SlabView& slab, const Ints* rows, const Ints* columns,
             const Quadrants& quadrants, Decided& decided)
{
  const Mask certain = quadrants.certain;
  setCells(slab, hn::Add(rows[1], columns[0]), all(certain, quadrants.crossed[1]));
  setCells(slab, hn::Add(rows[0], columns[1]), all(certain, quadrants.crossed[2]));
  decided.low = hn::Or(decided.low, all(certain, quadrants.crossed[0]));
  decided.high = hn::Or(decided.high, all(certain, quadrants.crossed[3]));
  decided.known = hn::Or(decided.known, certain);
}

std::size_t
crossBundles(const SlabView& view, const BundleView& bundles, std::size_t count,
             std::uint32_t* left)
{
  const SlabView slab = view; // a copy, which the bytes cannot alias
  std::size_t found = 0;
  const Ints one = set(1), number = set(slab.slab);
  const Floats zero = set(0.0f);
  // The farthest cells that the rays reach in the slab.
  const auto cellsAt = [&](Floats slope, auto leaves, float start) HWY_ATTR {
    const Floats distance = hn::IfThenElse(leaves, set(slab.leave), set(slab.enter));
    return cellsOf(sumOf(slope, distance, set(start)));
  };
  for (std::size_t i = 0; i < count; i += lanes) {
    const Floats r0 = load(bundles.row_low + i), r1 = load(bundles.row_high + i);
    const Floats c0 = load(bundles.column_low + i), c1 = load(bundles.column_high + i);
    const Cells row_low = cellsAt(r0, hn::Lt(r0, zero), slab.row_start);
    const Cells row_high = cellsAt(r1, hn::Gt(r1, zero), slab.row_start);
    const Cells column_low = cellsAt(c0, hn::Lt(c0, zero), slab.column_start);
    const Cells column_high = cellsAt(c1, hn::Gt(c1, zero), slab.column_start);
    const Ints rows[2] = {rowOffset(slab, row_low.cell),
                          rowOffset(slab, row_high.cell)};
    const Ints columns[2] = {columnOffset(slab, column_low.cell),
                             columnOffset(slab, column_high.cell)};
    const Ints row_extent = hn::Sub(row_high.cell, row_low.cell);
    const Ints column_extent = hn::Sub(column_high.cell, column_low.cell);
    const Mask exists = hn::AndNot(greater(number, load(bundles.longest + i)),
                                   hn::FirstN(IntTag(), count - i));
    const Ints off = hn::Max(hn::Max(row_low.off, row_high.off),
                             hn::Max(column_low.off, column_high.off));
    const Ints inside =
        hn::Or(hn::Or(rows[0], rows[1]), hn::Or(columns[0], columns[1]));
    const Mask sure = all(exists, isSure(slab, off), greater(inside, set(-1)),
                          greater(load(bundles.reach + i), number));
    Decided decided;
    decided.known =
        hn::Or(hn::AndNot(greater(hn::Add(row_extent, column_extent), one), sure),
               crossLines(slab, hn::Add(rows[0], columns[0]), sure, row_extent,
                          column_extent));
    decided.low = decided.high = decided.known;
    const Mask four = all(sure, hn::Eq(row_extent, one), hn::Eq(column_extent, one));
    if (any(four))
      crossCorners(slab, rows, columns,
                   quadrantsOf(slab, bundles, i, row_high.cell, column_high.cell, four),
                   decided);
    setCells(slab, hn::Add(rows[0], columns[0]), decided.low);
    setCells(slab, hn::Add(rows[1], columns[1]), decided.high);
    found += list(hn::AndNot(decided.known, exists), i, left + found);
  }
  return found;
}

// Cells at one side of a slab, and their offsets.
struct Side {
  Ints row, column, row_offset, column_offset;
  Mask sure;
};

HWY_INLINE Side
sideAt(const SlabView& slab, Floats u, Floats v, float distance, Mask known,
       Ints known_row, Ints known_column)
{
  const Cells rows = cellsOf(sumOf(u, set(distance), set(slab.row_start)));
  const Cells columns = cellsOf(sumOf(v, set(distance), set(slab.column_start)));
  Side side;
  side.row = hn::IfThenElse(known, known_row, rows.cell);
  side.column = hn::IfThenElse(known, known_column, columns.cell);
  side.row_offset = rowOffset(slab, side.row);
  side.column_offset = columnOffset(slab, side.column);
  side.sure = hn::Or(known, isSure(slab, hn::Max(rows.off, columns.off)));
  return side;
}

// All rays begin in the same voxel.
HWY_INLINE Side
firstSide(const SlabView& slab, Floats u, Floats v)
{
  const Ints zero = set(0);
  return sideAt(slab, u, v, slab.enter, hn::Eq(set(slab.slab), zero), zero, zero);
}

// On its last side a ray is in the cell of its end.
HWY_INLINE Side
lastSide(const SlabView& slab, Floats u, Floats v, Ints end_slab, Ints end_row,
         Ints end_column)
{
  return sideAt(slab, u, v, slab.leave, hn::Eq(end_slab, set(slab.slab)), end_row,
                end_column);
}

// Sets the cells of rays between two sides; returns the undecided rays.
HWY_INLINE Mask
crossCells(const SlabView& slab, Floats u, Floats v, const Side& a, const Side& b,
           Mask alive)
{
  const Ints zero = set(0), two = set(2), minus_two = set(-2);
  const Ints dr = hn::Sub(b.row, a.row);
  const Ints dc = hn::Sub(b.column, a.column);
  const Mask straight = hn::Or(hn::Eq(dr, zero), hn::Eq(dc, zero));
  Mask known = all(alive, a.sure, b.sure, greater(two, dr), greater(dr, minus_two),
                   greater(two, dc), greater(dc, minus_two));
  if (any(hn::AndNot(straight, alive))) {
    // The boundary that is crossed first determines the cell between both sides.
    const Ints row_boundary = hn::IfThenElse(greater(dr, zero), b.row, a.row);
    const Ints column_boundary = hn::IfThenElse(greater(dc, zero), b.column, a.column);
    const Floats from_row = hn::Sub(asFloats(row_boundary), set(slab.row_start));
    const Floats from_column =
        hn::Sub(asFloats(column_boundary), set(slab.column_start));
    const Floats order =
        hn::Sub(hn::Mul(hn::Mul(asFloats(dr), from_row), hn::Abs(v)),
                hn::Mul(hn::Mul(asFloats(dc), from_column), hn::Abs(u)));
    known =
        all(known, hn::Or(straight, greater(hn::Abs(order), set(2.0f * slab.margin))));
    const Mask row_first = greater(set(0.0f), order);
    setCellsInside(slab, hn::IfThenElse(row_first, b.row_offset, a.row_offset),
                   hn::IfThenElse(row_first, a.column_offset, b.column_offset),
                   hn::AndNot(straight, known));
  }
  setCellsInside(slab, a.row_offset, a.column_offset, known);
  setCellsInside(slab, b.row_offset, b.column_offset, known);
  return hn::AndNot(known, alive);
}

std::size_t
crossSlabs(const SlabView* slabs, std::size_t slab_count, const RayView& rays,
           std::size_t count, RaySlab* left)
{
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Floats u = load(rays.row_slope + i), v = load(rays.column_slope + i);
    const Ints end_slab = load(rays.end_slab + i);
    const Ints end_row = load(rays.end_row + i);
    const Ints end_column = load(rays.end_column + i);
    const Mask exists = hn::FirstN(IntTag(), count - i);
    Side a = firstSide(slabs[0], u, v);
    for (std::size_t n = 0; n < slab_count; ++n) {
      const SlabView slab = slabs[n];
      const Mask alive = hn::AndNot(greater(set(slab.slab), end_slab), exists);
      if (!any(alive))
        break;
      const Side b = lastSide(slab, u, v, end_slab, end_row, end_column);
      const Mask undecided = crossCells(slab, u, v, a, b, alive);
      for (unsigned bits = bitsOf(undecided); bits != 0; bits &= bits - 1)
        left[found++] = {std::uint32_t(i) + unsigned(__builtin_ctz(bits)),
                         std::uint32_t(slab.slab)};
      a = b;
    }
  }
  return found;
}

std::size_t
crossRays(const SlabView& view, const RayView& rays, std::size_t count,
          std::uint32_t* left)
{
  const SlabView slab = view;
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Floats u = load(rays.row_slope + i), v = load(rays.column_slope + i);
    const Ints end_slab = load(rays.end_slab + i);
    const Mask alive =
        hn::AndNot(greater(set(slab.slab), end_slab), hn::FirstN(IntTag(), count - i));
    const Side b = lastSide(slab, u, v, end_slab, load(rays.end_row + i),
                            load(rays.end_column + i));
    const Mask undecided = crossCells(slab, u, v, firstSide(slab, u, v), b, alive);
    found += list(undecided, i, left + found);
  }
  return found;
}

constexpr SlabCrossing loops = {crossBundles, crossRays, crossSlabs};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

const SlabCrossing&
slabCrossing(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

} // namespace pcl_semantic::kernels
#endif
