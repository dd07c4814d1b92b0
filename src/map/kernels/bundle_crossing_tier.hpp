/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, with PCL_SEMANTIC_TARGET its instruction set and
// PCL_SEMANTIC_LANES its width.

#define PCL_SEMANTIC_INLINE inline PCL_SEMANTIC_TARGET __attribute__((always_inline))

constexpr std::size_t lanes = PCL_SEMANTIC_LANES;
typedef float Floats __attribute__((vector_size(4 * lanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * lanes)));
typedef std::uint32_t Words __attribute__((vector_size(4 * lanes)));

// Vectors anywhere in memory.
struct Unaligned {
  typedef Floats F __attribute__((aligned(4), may_alias));
  typedef Ints I __attribute__((aligned(4), may_alias));
};

PCL_SEMANTIC_INLINE Floats
load(const float* from)
{
  return *reinterpret_cast<const Unaligned::F*>(from);
}

PCL_SEMANTIC_INLINE Ints
load(const std::int32_t* from)
{
  return *reinterpret_cast<const Unaligned::I*>(from);
}

PCL_SEMANTIC_INLINE void
store(const Ints& values, std::int32_t* to)
{
  *reinterpret_cast<Unaligned::I*>(to) = values;
}

PCL_SEMANTIC_INLINE Ints
lane()
{
  Ints numbers{};
  for (std::size_t k = 0; k < lanes; ++k)
    numbers[k] = std::int32_t(k);
  return numbers;
}

// A bit for each lane that is set.
PCL_SEMANTIC_INLINE unsigned
bitsOf(const Ints& wanted)
{
  return unsigned(PCL_SEMANTIC_BITS(wanted));
}

PCL_SEMANTIC_INLINE Floats
magnitude(const Floats& values)
{
  return values < 0.0f ? -values : values;
}

// Cells that hold positions; whether they certainly do.
struct Cells {
  Ints cell, sure;
};

PCL_SEMANTIC_INLINE Cells
cellsOf(const Floats& position, float margin)
{
  const float magic = 12582912.0f; // 1.5 * 2^23: a sum with it is rounded to an integer
  const Floats centred = position - 0.5f;
  const Floats rounded = centred + magic;
  const Floats from_centre = centred - (rounded - magic);
  return {(Ints)rounded - 0x4B400000, magnitude(from_centre) < 0.5f - margin};
}

// Rows or columns of cells among the bytes: what they add to a place, and whether they
// are inside.
struct Part {
  Ints place, inside;
};

PCL_SEMANTIC_INLINE Part
rowPart(const SlabView& slab, const Ints& row)
{
  const Ints r = row - slab.first_row;
  return {r << 3, (Ints)((Words)r < std::uint32_t(slab.rows))};
}

PCL_SEMANTIC_INLINE Part
columnPart(const SlabView& slab, const Ints& column)
{
  const Ints c = column - slab.first_column;
  return {c * slab.column_stride, (Ints)((Words)c < std::uint32_t(slab.columns))};
}

// Sets the bytes of the wanted cells. By way of memory: taking lanes out of a vector
// one by one costs more than all the rest.
PCL_SEMANTIC_INLINE void
setCells(const SlabView& slab, std::uint8_t* cells, const Part& row, const Part& column,
         const Ints& wanted)
{
  std::int32_t place[lanes];
  const Ints inside = wanted & row.inside & column.inside;
  store(inside ? row.place + column.place : slab.nowhere - Ints{}, place);
  __asm__ volatile("" : "+m"(place));
  for (std::size_t k = 0; k < lanes; ++k)
    cells[std::uint32_t(place[k])] = 1;
}

// Appends the numbers of the lanes that are set.
PCL_SEMANTIC_INLINE std::size_t
list(const Ints& wanted, std::size_t first, std::uint32_t* to)
{
  std::size_t count = 0;
  for (unsigned bits = bitsOf(wanted); bits != 0; bits &= bits - 1)
    to[count++] = std::uint32_t(first) + unsigned(__builtin_ctz(bits));
  return count;
}

PCL_SEMANTIC_INLINE bool
any(const Ints& wanted)
{
  return bitsOf(wanted) != 0;
}

// Four cells around a corner, numbered as the rays at the corners: whether a ray of the
// bundle is in them when it enters the slab or leaves it; whether it is certain for all
// of them that one is or that no ray crosses the cell.
struct Quadrants {
  Ints crossed[4], certain;
};

PCL_SEMANTIC_INLINE Quadrants
quadrantsOf(const SlabView& slab, const BundleView& bundles, std::size_t i,
            const Ints& row_boundary, const Ints& column_boundary)
{
  const Floats row = slab.row_start - __builtin_convertvector(row_boundary, Floats);
  const Floats column =
      slab.column_start - __builtin_convertvector(column_boundary, Floats);
  Quadrants quadrants;
  quadrants.certain = ~Ints{};
  for (int corner = 0; corner < 4; ++corner) {
    // Beyond the boundary on the side of the corner: positive.
    const float row_side = corner & 1 ? 1.0f : -1.0f;
    const float column_side = corner & 2 ? 1.0f : -1.0f;
    const Floats u = load(bundles.corner_row[corner] + i) * row_side;
    const Floats v = load(bundles.corner_column[corner] + i) * column_side;
    const Floats row_start = row * row_side, column_start = column * column_side;
    const Floats row_enter = u * slab.enter + row_start;
    const Floats row_leave = u * slab.leave + row_start;
    const Floats column_enter = v * slab.enter + column_start;
    const Floats column_leave = v * slab.leave + column_start;
    const Ints row_before = row_enter > slab.margin,
               row_behind = row_leave > slab.margin;
    const Ints column_before = column_enter > slab.margin,
               column_behind = column_leave > slab.margin;
    // In it on the way: beyond one boundary before it comes back over the other.
    const Floats order = u * column_start - v * row_start;
    quadrants.crossed[corner] =
        (row_before & column_before) | (row_behind & column_behind) |
        (row_behind & column_before & (order > 2.0f * slab.margin)) |
        (row_before & column_behind & (order < -2.0f * slab.margin));
    // No other ray goes further in the sum of both, which is linear on its way.
    const Ints empty = (row_enter + column_enter < -2.0f * slab.margin) &
                       (row_leave + column_leave < -2.0f * slab.margin);
    quadrants.certain &= quadrants.crossed[corner] | empty;
  }
  return quadrants;
}

// Bundles that are decided; those of which the first cell is crossed, and the last.
struct Decided {
  Ints known, low, high;
};

// Sets the middle one of three cells in a line, and gives the bundles that cross three:
// as they are not wider than a cell, they cannot miss it.
PCL_SEMANTIC_INLINE Ints
crossLines(const SlabView& slab, const Part& row, const Part& column, const Ints& sure,
           const Ints& row_extent, const Ints& column_extent)
{
  const Ints by_row = (row_extent == 2) & (column_extent == 0);
  const Ints by_column = (row_extent == 0) & (column_extent == 2);
  const Ints three = sure & (by_row | by_column);
  if (any(three))
    setCells(slab, slab.cells, {row.place + (by_row & 8), row.inside},
             {column.place + (by_column & slab.column_stride), column.inside}, three);
  return three;
}

PCL_SEMANTIC_INLINE void
crossCorners(const SlabView& slab, const Part* rows, const Part* columns,
             const Ints& four, const Quadrants& quadrants, Decided& decided)
{
  const Ints certain = four & quadrants.certain;
  setCells(slab, slab.cells, rows[1], columns[0], certain & quadrants.crossed[1]);
  setCells(slab, slab.cells, rows[0], columns[1], certain & quadrants.crossed[2]);
  decided.low |= certain & quadrants.crossed[0];
  decided.high |= certain & quadrants.crossed[3];
  decided.known |= certain;
}

PCL_SEMANTIC_TARGET std::size_t
crossBundles(const SlabView& slab, const BundleView& bundles, std::size_t count,
             std::uint32_t* left)
{
  std::size_t found = 0;
  const float margin = slab.margin;
  const Floats enter = slab.enter - Floats{}, leave = slab.leave - Floats{};
  for (std::size_t i = 0; i < count; i += lanes) {
    const Floats r0 = load(bundles.row_low + i), r1 = load(bundles.row_high + i);
    const Floats c0 = load(bundles.column_low + i), c1 = load(bundles.column_high + i);
    // The widest range that the rays take on their way through the slab.
    const Cells row_low =
        cellsOf(r0 * (r0 < 0.0f ? leave : enter) + slab.row_start, margin);
    const Cells row_high =
        cellsOf(r1 * (r1 > 0.0f ? leave : enter) + slab.row_start, margin);
    const Cells column_low =
        cellsOf(c0 * (c0 < 0.0f ? leave : enter) + slab.column_start, margin);
    const Cells column_high =
        cellsOf(c1 * (c1 > 0.0f ? leave : enter) + slab.column_start, margin);
    const Part rows[2] = {rowPart(slab, row_low.cell), rowPart(slab, row_high.cell)};
    const Part columns[2] = {columnPart(slab, column_low.cell),
                             columnPart(slab, column_high.cell)};
    const Ints row_extent = row_high.cell - row_low.cell;
    const Ints column_extent = column_high.cell - column_low.cell;
    const Ints exists =
        (lane() < std::int32_t(count - i)) & (load(bundles.longest + i) >= slab.slab);
    const Ints inside = row_low.sure & row_high.sure & column_low.sure &
                        column_high.sure & exists & rows[0].inside & rows[1].inside &
                        columns[0].inside & columns[1].inside;
    const Ints sure = inside & (load(bundles.reach + i) > slab.slab);
    Decided decided;
    decided.known = sure & (row_extent + column_extent <= 1);
    decided.known |=
        crossLines(slab, rows[0], columns[0], sure, row_extent, column_extent);
    decided.low = decided.high = decided.known;
    const Ints four = sure & (row_extent == 1) & (column_extent == 1);
    if (any(four)) {
      const Quadrants quadrants =
          quadrantsOf(slab, bundles, i, row_high.cell, column_high.cell);
      crossCorners(slab, rows, columns, four, quadrants, decided);
    }
    setCells(slab, slab.cells, rows[0], columns[0], decided.low);
    setCells(slab, slab.cells, rows[1], columns[1], decided.high);
    found += list(~decided.known & exists, i, left + found);
  }
  return found;
}
