// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_filter.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/lattice_filter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t points_ahead = 12; // to be fetched
constexpr std::size_t rows_ahead = 16;   // to be fetched

// A row of values on the lattice: as many vectors as it takes.
template <std::size_t width> struct Row {
  using Tag = hn::CappedTag<float, width>;
  static constexpr std::size_t lanes = hn::MaxLanes(Tag());
  static constexpr std::size_t parts = width / lanes;

  Row() = default;
  HWY_INLINE explicit Row(const float* from)
  {
    for (std::size_t b = 0; b < parts; ++b)
      part[b] = hn::LoadU(Tag(), from + b * lanes);
  }

  HWY_INLINE void
  store(float* to) const
  {
    for (std::size_t b = 0; b < parts; ++b)
      hn::StoreU(part[b], Tag(), to + b * lanes);
  }

  HWY_INLINE Row
  operator+(const Row& other) const
  {
    Row sum;
    for (std::size_t b = 0; b < parts; ++b)
      sum.part[b] = hn::Add(part[b], other.part[b]);
    return sum;
  }

  HWY_INLINE Row
  operator-(const Row& other) const
  {
    Row difference;
    for (std::size_t b = 0; b < parts; ++b)
      difference.part[b] = hn::Sub(part[b], other.part[b]);
    return difference;
  }

  HWY_INLINE Row
  operator*(float factor) const
  {
    Row product;
    for (std::size_t b = 0; b < parts; ++b)
      product.part[b] = hn::Mul(part[b], hn::Set(Tag(), factor));
    return product;
  }

  HWY_INLINE static Row
  zero()
  {
    Row row;
    for (std::size_t b = 0; b < parts; ++b)
      row.part[b] = hn::Zero(Tag());
    return row;
  }

  hn::Vec<Tag> part[parts];
};

// Reads a whole row of values; what lies behind the rows of interest does no harm, but
// memory must not end there.
template <std::size_t width>
HWY_INLINE Row<width>
loadValues(const LatticeColumns& columns, std::size_t column)
{
  const float* from = columns.values + column * columns.values_stride;
  float last[width];
  if (from + width > columns.end) {
    for (std::size_t r = 0; r < width; ++r)
      last[r] = r < columns.rows ? from[r] : 0.0f;
    from = last;
  }
  return Row<width>(from);
}

// Columns are not in the order of memory: to be fetched some points ahead.
HWY_INLINE std::size_t
laterColumn(const LatticePoints& points, std::size_t i)
{
  const std::size_t later = i + points_ahead;
  return std::size_t(points.columns[later < points.count ? later : i]);
}

template <std::size_t width>
void
splat(const LatticePoints& points, const LatticeColumns& columns, float* lattice)
{
  using Values = Row<width>;
  for (std::size_t p = 0; p < points.partials; ++p)
    Values::zero().store(lattice + (points.first_partial + p) * width);
  std::size_t begun = points.first_row;
  for (std::size_t begin = 0; begin < points.count; begin += row_end_points) {
    // Rows are begun shortly before they are needed: they are in the fast cache then.
    const auto row_end = std::size_t(points.row_ends[begin / row_end_points]);
    for (; begun < row_end; ++begun) {
      __builtin_prefetch(lattice + (begun + rows_ahead) * width, 1);
      Values::zero().store(lattice + begun * width);
    }
    const std::size_t end =
        begin + row_end_points < points.count ? begin + row_end_points : points.count;
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = std::size_t(points.columns[i]);
      __builtin_prefetch(columns.values +
                         laterColumn(points, i) * columns.values_stride);
      const Values value =
          loadValues<width>(columns, column) * columns.splat_scale[column];
      for (std::size_t k = i * points.corners; k < (i + 1) * points.corners; ++k) {
        float* const row = lattice + std::size_t(points.rows[k]) * width;
        (Values(row) + value * points.weights[k]).store(row);
      }
    }
  }
}

template <std::size_t width>
void
merge(const std::int32_t* vertices, std::size_t count, const std::uint32_t* ends,
      const std::int32_t* partials, float* lattice)
{
  using Values = Row<width>;
  for (std::size_t m = 0; m < count; ++m) {
    float* const row = lattice + std::size_t(vertices[m]) * width;
    const std::size_t later = m + rows_ahead < count ? m + rows_ahead : m;
    __builtin_prefetch(lattice + std::size_t(vertices[later]) * width, 1);
    __builtin_prefetch(lattice + std::size_t(partials[ends[later] - 1]) * width);
    Values sum(row);
    for (std::uint32_t p = ends[std::ptrdiff_t(m) - 1]; p < ends[m]; ++p)
      sum = sum + Values(lattice + std::size_t(partials[p]) * width);
    sum.store(row);
  }
}

template <std::size_t width>
void
blur(const std::int32_t* steps, std::size_t count, float* lattice)
{
  using Values = Row<width>;
  const auto rowOf = [&](std::size_t step) HWY_ATTR {
    return lattice + std::size_t(steps[step] & ~run_end) * width;
  };
  // Runs are of a few vertices: a branch at their ends would be mispredicted.
  const float share[2] = {0.5f, 0.0f};
  float from_back = 0.0f;
  Values back = Values::zero(), here(rowOf(0));
  for (std::size_t t = 0; t < count; ++t) {
    __builtin_prefetch(rowOf(t + steps_ahead), 1);
    const Values ahead(rowOf(t + 1));
    const float from_ahead = share[std::uint32_t(steps[t]) >> 31];
    (here + (back * from_back + ahead * from_ahead)).store(rowOf(t));
    back = here;
    here = ahead;
    from_back = from_ahead;
  }
}

// result += added, for the rows of interest.
template <std::size_t width>
HWY_INLINE void
addToResult(const LatticeColumns& columns, std::size_t column, const Row<width>& added)
{
  float* const result = columns.result + column * columns.result_stride;
  if (columns.rows == width) {
    (Row<width>(result) + added).store(result);
    return;
  }
  float some[width];
  added.store(some);
  for (std::size_t r = 0; r < columns.rows; ++r)
    result[r] = result[r] + some[r];
}

template <std::size_t width>
void
slice(const LatticePoints& points, const LatticeColumns& columns, float* lattice,
      std::size_t half)
{
  using Values = Row<width>;
  for (std::size_t h = 0; h < 2; ++h)
    for (std::size_t p = 0; p < points.partials; ++p)
      Values(lattice + std::size_t(points.represents[p]) * width + h * half)
          .store(lattice + (points.first_partial + p) * width + h * half);
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto column = std::size_t(points.columns[i]);
    const std::size_t later = laterColumn(points, i);
    __builtin_prefetch(columns.values + later * columns.values_stride);
    __builtin_prefetch(columns.result + later * columns.result_stride, 1);
    Values sum = Values::zero();
    for (std::size_t k = i * points.corners; k < (i + 1) * points.corners; ++k) {
      const float* const row = lattice + std::size_t(points.rows[k]) * width;
      const Values mean = (Values(row) + Values(row + half)) * 0.5f;
      sum = sum + mean * points.weights[k];
    }
    addToResult<width>(columns, column,
                       sum * columns.slice_scale[column] -
                           loadValues<width>(columns, column) *
                               columns.diagonal[column]);
  }
}

template <std::size_t width>
constexpr LatticeFilter loops = {splat<width>, merge<width>, blur<width>, slice<width>};

constexpr LatticeFilter filters[4] = {loops<1>, loops<4>, loops<8>, loops<16>};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

const LatticeFilter&
latticeFilter(SimdTier tier, std::size_t width)
{
  const int number = width == 1 ? 0 : width == 4 ? 1 : width == 8 ? 2 : 3;
  return PCL_SEMANTIC_OF_TIER(tier, filters)[number];
}

} // namespace pcl_semantic::kernels
#endif
