/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, behind bundle_crossing_tier.hpp: rays around a corner of cells.

// Four cells: bit 0 is set in the upper row, bit 1 in the upper column.
PCL_SEMANTIC_INLINE unsigned
quadrantsOf(const Ints& row, const Ints& column, const Ints& wanted)
{
  return unsigned(any(wanted & ~row & ~column)) |
         unsigned(any(wanted & row & ~column)) << 1 |
         unsigned(any(wanted & ~row & column)) << 2 |
         unsigned(any(wanted & row & column)) << 3;
}

PCL_SEMANTIC_INLINE void
setQuadrants(const SlabView& slab, int row, int column, unsigned quadrants)
{
  std::uint8_t* const low = slab.cells +
                            (column - 1 - slab.first_column) * slab.column_stride +
                            (row - 1 - slab.first_row) * 8;
  std::uint8_t* const high = low + slab.column_stride;
  low[0] |= quadrants & 1;
  low[8] |= quadrants >> 1 & 1;
  high[0] |= quadrants >> 2 & 1;
  high[8] |= quadrants >> 3 & 1;
}

PCL_SEMANTIC_TARGET std::size_t
crossCorners(const SlabView& slab, const RayView& rays, const CornerRays* corners,
             std::size_t count, std::uint32_t* left)
{
  std::size_t found = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const CornerRays& corner = corners[n];
    // Positions from the corner.
    const float row_start = slab.row_start - float(corner.row);
    const float column_start = slab.column_start - float(corner.column);
    unsigned quadrants = 0;
    for (std::size_t i = corner.rays.begin; i < corner.rays.end; i += lanes) {
      const Floats u = load(rays.row_slope + i), v = load(rays.column_slope + i);
      const Ints end_slab = load(rays.end_slab + i);
      const Ints alive =
          (end_slab >= slab.slab) & (lane() < std::int32_t(corner.rays.end - i));
      const Ints last = end_slab == slab.slab;
      const Floats row_enter = u * slab.enter + row_start;
      const Floats row_leave = u * slab.leave + row_start;
      const Floats column_enter = v * slab.enter + column_start;
      const Floats column_leave = v * slab.leave + column_start;
      const Ints row_a = row_enter > 0.0f, column_a = column_enter > 0.0f;
      const Ints row_b = last ? load(rays.end_row + i) >= corner.row : row_leave > 0.0f;
      const Ints column_b =
          last ? load(rays.end_column + i) >= corner.column : column_leave > 0.0f;
      const Ints diagonal = (row_a != row_b) & (column_a != column_b);
      // Of two boundaries, the one that is crossed first decides on the cell between.
      const Floats row_way = row_b ? Floats{} - row_start : row_start - Floats{};
      const Floats column_way =
          column_b ? Floats{} - column_start : column_start - Floats{};
      const Floats order = row_way * magnitude(v) - column_way * magnitude(u);
      const Ints row_first = order < 0.0f;
      const Ints known = (magnitude(row_enter) > slab.margin) &
                         (magnitude(column_enter) > slab.margin) &
                         ((magnitude(row_leave) > slab.margin) | last) &
                         ((magnitude(column_leave) > slab.margin) | last) &
                         (~diagonal | (magnitude(order) > 2.0f * slab.margin));
      const Ints set = known & alive;
      quadrants |=
          quadrantsOf(row_a, column_a, set) | quadrantsOf(row_b, column_b, set);
      if (any(diagonal & set))
        quadrants |= quadrantsOf(row_first ? row_b : row_a,
                                 row_first ? column_a : column_b, set & diagonal);
      found += list(~known & alive, i, left + found);
    }
    setQuadrants(slab, corner.row, corner.column, quadrants);
  }
  return found;
}
