/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, behind bundle_crossing_tier.hpp: rays one by one.

// Cells at one side of a slab, among the bytes too.
struct Side {
  Cells row, column;
  Part row_part, column_part;
};

PCL_SEMANTIC_INLINE Side
sideAt(const SlabView& slab, const Floats& u, const Floats& v, float distance)
{
  Side side;
  side.row = cellsOf(u * distance + slab.row_start, slab.margin);
  side.column = cellsOf(v * distance + slab.column_start, slab.margin);
  return side;
}

PCL_SEMANTIC_INLINE void
setParts(const SlabView& slab, Side& side)
{
  side.row_part = rowPart(slab, side.row.cell);
  side.column_part = columnPart(slab, side.column.cell);
}

// Sets the cells of rays on their way from one side to the other; gives which of them
// cannot be decided.
PCL_SEMANTIC_INLINE Ints
crossCells(const SlabView& slab, std::uint8_t* cells, const Floats& u, const Floats& v,
           const Side& a, const Side& b, const Ints& alive)
{
  const Ints dr = b.row.cell - a.row.cell, dc = b.column.cell - a.column.cell;
  const Ints diagonal = (dr != 0) & (dc != 0);
  Ints known = a.row.sure & b.row.sure & a.column.sure & b.column.sure & (dr <= 1) &
               (dr >= -1) & (dc <= 1) & (dc >= -1);
  if (any(diagonal & alive)) {
    // Of two boundaries, the one that is crossed first decides on the cell between.
    const Floats row_boundary =
        __builtin_convertvector(dr > 0 ? b.row.cell : a.row.cell, Floats) -
        slab.row_start;
    const Floats column_boundary =
        __builtin_convertvector(dc > 0 ? b.column.cell : a.column.cell, Floats) -
        slab.column_start;
    const Floats order =
        __builtin_convertvector(dr, Floats) * row_boundary * magnitude(v) -
        __builtin_convertvector(dc, Floats) * column_boundary * magnitude(u);
    known &= ~diagonal | (magnitude(order) > 2.0f * slab.margin);
    const Ints row_first = order < 0.0f;
    const Part row = {row_first ? b.row_part.place : a.row_part.place,
                      row_first ? b.row_part.inside : a.row_part.inside};
    const Part column = {row_first ? a.column_part.place : b.column_part.place,
                         row_first ? a.column_part.inside : b.column_part.inside};
    setCells(slab, cells, row, column, known & alive & diagonal);
  }
  setCells(slab, cells, a.row_part, a.column_part, known & alive);
  setCells(slab, cells, b.row_part, b.column_part, known & alive);
  return ~known & alive;
}

// A ray's last side is the cell it ends in.
PCL_SEMANTIC_INLINE void
endIn(const Ints& last, const Ints& end_row, const Ints& end_column, Side& side)
{
  side.row = {last ? end_row : side.row.cell, side.row.sure | last};
  side.column = {last ? end_column : side.column.cell, side.column.sure | last};
}

PCL_SEMANTIC_INLINE Side
firstSide(const SlabView& slab, const Floats& u, const Floats& v)
{
  Side side = sideAt(slab, u, v, slab.enter);
  if (slab.slab == 0) { // all begin in the same voxel
    const Ints zero{};
    side.row = side.column = {zero, ~zero};
  }
  setParts(slab, side);
  return side;
}

PCL_SEMANTIC_TARGET std::size_t
crossRays(const SlabView& slab, const RayView& rays, std::size_t count,
          std::uint32_t* left)
{
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Floats u = load(rays.row_slope + i), v = load(rays.column_slope + i);
    const Ints end_slab = load(rays.end_slab + i);
    const Ints alive = (end_slab >= slab.slab) & (lane() < std::int32_t(count - i));
    const Side a = firstSide(slab, u, v);
    Side b = sideAt(slab, u, v, slab.leave);
    endIn(end_slab == slab.slab, load(rays.end_row + i), load(rays.end_column + i), b);
    setParts(slab, b);
    const Ints undecided = crossCells(slab, slab.cells, u, v, a, b, alive);
    found += list(undecided, i, left + found);
  }
  return found;
}

PCL_SEMANTIC_TARGET std::size_t
crossSlabs(const SlabView* slabs, std::size_t slab_count, const RayView& rays,
           std::size_t count, RaySlab* left)
{
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; i += lanes) {
    const Floats u = load(rays.row_slope + i), v = load(rays.column_slope + i);
    const Ints end_slab = load(rays.end_slab + i);
    const Ints end_row = load(rays.end_row + i);
    const Ints end_column = load(rays.end_column + i);
    const Ints exists = lane() < std::int32_t(count - i);
    Side a = firstSide(slabs[0], u, v);
    for (std::size_t n = 0; n < slab_count; ++n) {
      const SlabView& slab = slabs[n];
      const Ints alive = (end_slab >= slab.slab) & exists;
      if (!any(alive))
        break;
      Side b = sideAt(slab, u, v, slab.leave);
      endIn(end_slab == slab.slab, end_row, end_column, b);
      setParts(slab, b);
      const Ints undecided = crossCells(slab, slab.cells, u, v, a, b, alive);
      for (unsigned bits = bitsOf(undecided); bits != 0; bits &= bits - 1)
        left[found++] = {std::uint32_t(i) + unsigned(__builtin_ctz(bits)),
                         std::uint32_t(slab.slab)};
      a = b;
    }
  }
  return found;
}
