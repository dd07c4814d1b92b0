// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_loops.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/lattice_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Lanes of the set-up loops, which the compiler vectorises.
constexpr std::size_t lanes = batch_points;

// Rounds coordinates on the plane to the nearest cells; returns cells and remainders.
void
elevate(const LatticeFrame& frame, const float* features, const std::int32_t* columns,
        LatticeBatch& batch, float (&left)[max_dimensions + 1][lanes])
{
  constexpr double magic = 6755399441055744.0; // 1.5 * 2^52: adding it rounds to an
                                               // integer
  double sum[lanes] = {}, x[lanes];
  for (int j = frame.dimensions; j >= 0; --j) {
    if (j > 0)
      for (std::size_t i = 0; i < lanes; ++i)
        x[i] = double(features[std::size_t(columns[i]) * std::size_t(frame.dimensions) +
                               std::size_t(j) - 1]);
    const double low = j > 0 ? frame.low[j - 1] : 0.0, scale = frame.scale[j];
    for (std::size_t i = 0; i < lanes; ++i) {
      const double step = j > 0 ? (x[i] - low) * scale : 0.0;
      const double coordinate = sum[i] - double(j) * step;
      const double nearest = coordinate + magic - magic;
      sum[i] += step;
      batch.cells[j][i] = std::int32_t(nearest);
      left[j][i] = float(coordinate - nearest);
    }
  }
}

// Ranks the remainders, largest first, and returns to the plane: the sum of the cells,
// which is the excess of the ranks, becomes 0.
void
rank(int d, LatticeBatch& batch, float (&left)[max_dimensions + 1][lanes],
     std::int32_t (&ranks)[max_dimensions + 1][lanes])
{
  std::int32_t excess[lanes] = {};
  for (int j = 0; j <= d; ++j)
    for (std::size_t i = 0; i < lanes; ++i) {
      excess[i] += batch.cells[j][i];
      ranks[j][i] = 0;
    }
  for (int j = 0; j < d; ++j)
    for (int l = j + 1; l <= d; ++l)
      for (std::size_t i = 0; i < lanes; ++i) {
        const std::int32_t less = left[j][i] < left[l][i] ? 1 : 0;
        ranks[j][i] += less;
        ranks[l][i] += 1 - less;
      }
  for (int j = 0; j <= d; ++j)
    for (std::size_t i = 0; i < lanes; ++i) {
      const std::int32_t moved = ranks[j][i] + excess[i];
      const std::int32_t turn = moved < 0 ? 1 : moved > d ? -1 : 0;
      ranks[j][i] = moved + turn * (d + 1);
      batch.cells[j][i] += turn;
      left[j][i] -= float(turn);
    }
}

void
embed(const LatticeFrame& frame, const float* features, const std::int32_t* columns,
      LatticeBatch& batch)
{
  const int d = frame.dimensions;
  float left[max_dimensions + 1][lanes];
  std::int32_t ranks[max_dimensions + 1][lanes];
  elevate(frame, features, columns, batch, left);
  rank(d, batch, left, ranks);
  // Differences of the sorted remainders are the barycentric weights.
  float sorted[max_dimensions + 1][lanes];
  for (int k = 0; k <= d; ++k) {
    for (std::size_t i = 0; i < lanes; ++i) {
      sorted[k][i] = 0.0f;
      batch.directions[k][i] = 0;
    }
    for (int j = 0; j <= d; ++j)
      for (std::size_t i = 0; i < lanes; ++i) {
        const bool is_next = ranks[j][i] == d - k;
        sorted[k][i] = is_next ? left[j][i] : sorted[k][i];
        batch.directions[k][i] = is_next ? j : batch.directions[k][i];
      }
  }
  for (std::size_t i = 0; i < lanes; ++i)
    batch.weights[0][i] = sorted[0][i] + (1.0f - sorted[d][i]);
  for (int k = 1; k <= d; ++k)
    for (std::size_t i = 0; i < lanes; ++i)
      batch.weights[k][i] = sorted[k][i] - sorted[k - 1][i];
}

constexpr std::size_t points_ahead = 12; // prefetch distance

// A row of values on the lattice in one or more vectors.
template <std::size_t width> struct Row {
  using Tag = hn::CappedTag<float, width>;
  static constexpr std::size_t lanes = hn::MaxLanes(Tag());
  static constexpr std::size_t parts = width / lanes;

  hn::Vec<Tag> part[parts];
};

template <std::size_t width>
HWY_INLINE Row<width>
load(const float* from)
{
  Row<width> row;
  for (std::size_t b = 0; b < row.parts; ++b)
    row.part[b] = hn::LoadU(typename Row<width>::Tag(), from + b * row.lanes);
  return row;
}

template <std::size_t width>
HWY_INLINE void
store(const Row<width>& row, float* to)
{
  for (std::size_t b = 0; b < row.parts; ++b)
    hn::StoreU(row.part[b], typename Row<width>::Tag(), to + b * row.lanes);
}

constexpr float zeros[16] = {};

template <std::size_t width>
HWY_INLINE Row<width>
operator+(const Row<width>& a, const Row<width>& b)
{
  Row<width> sum;
  for (std::size_t i = 0; i < sum.parts; ++i)
    sum.part[i] = hn::Add(a.part[i], b.part[i]);
  return sum;
}

template <std::size_t width>
HWY_INLINE Row<width>
operator*(const Row<width>& row, float factor)
{
  Row<width> product;
  for (std::size_t i = 0; i < row.parts; ++i)
    product.part[i] = hn::Mul(row.part[i], hn::Set(typename Row<width>::Tag(), factor));
  return product;
}

// Reads a whole row of values. Values beyond the rows of interest are ignored, but must
// be readable memory.
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
  return load<width>(from);
}

// Column to prefetch: columns are not in memory order.
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
  for (std::size_t p = 0; p < points.partials; ++p)
    store(load<width>(zeros), lattice + (points.first_partial + p) * width);
  for (std::size_t p = 0; p < points.own_rows; ++p)
    store(load<width>(zeros), lattice + (points.first_row + p) * width);
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto column = std::size_t(points.columns[i]);
    __builtin_prefetch(columns.values + laterColumn(points, i) * columns.values_stride);
    const Row<width> value =
        loadValues<width>(columns, column) * columns.splat_scale[column];
    for (std::size_t k = i * points.corners; k < (i + 1) * points.corners; ++k) {
      float* const row = lattice + std::size_t(points.rows[k]) * width;
      store(load<width>(row) + value * points.weights[k], row);
    }
  }
}

template <std::size_t width>
void
merge(const std::int32_t* partials, std::size_t count, const std::int32_t* represents,
      std::size_t vertices, float* lattice)
{
  for (std::size_t m = 0; m < count; ++m) {
    const auto partial = std::size_t(partials[m]);
    float* const row = lattice + std::size_t(represents[partial]) * width;
    store(load<width>(row) + load<width>(lattice + (vertices + partial) * width), row);
  }
}

template <std::size_t width>
void
blur(const std::int32_t* steps, std::size_t count, float* lattice)
{
  const auto rowOf = [&](std::size_t step) HWY_ATTR {
    return lattice + std::size_t(steps[step] & ~run_end) * width;
  };
  // Runs have few vertices, so a branch at their ends would be mispredicted.
  const float share[2] = {0.5f, 0.0f};
  float from_back = 0.0f;
  Row<width> back = load<width>(zeros), here = load<width>(rowOf(0));
  for (std::size_t t = 0; t < count; ++t) {
    __builtin_prefetch(rowOf(t + steps_ahead), 1);
    const Row<width> ahead = load<width>(rowOf(t + 1));
    const float from_ahead = share[std::uint32_t(steps[t]) >> 31];
    store(here + (back * from_back + ahead * from_ahead), rowOf(t));
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
    store(load<width>(result) + added, result);
    return;
  }
  float some[width];
  store(added, some);
  for (std::size_t r = 0; r < columns.rows; ++r)
    result[r] = result[r] + some[r];
}

template <std::size_t width>
void
slice(const LatticePoints& points, const LatticeColumns& columns, float* lattice,
      std::size_t half)
{
  for (std::size_t h = 0; h < 2; ++h)
    for (std::size_t p = 0; p < points.partials; ++p)
      store(load<width>(lattice + std::size_t(points.represents[p]) * width + h * half),
            lattice + (points.first_partial + p) * width + h * half);
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto column = std::size_t(points.columns[i]);
    const std::size_t later = laterColumn(points, i);
    __builtin_prefetch(columns.values + later * columns.values_stride);
    __builtin_prefetch(columns.result + later * columns.result_stride, 1);
    Row<width> sum = load<width>(zeros);
    for (std::size_t k = i * points.corners; k < (i + 1) * points.corners; ++k) {
      const float* const row = lattice + std::size_t(points.rows[k]) * width;
      const Row<width> mean = (load<width>(row) + load<width>(row + half)) * 0.5f;
      sum = sum + mean * points.weights[k];
    }
    addToResult<width>(columns, column,
                       sum * columns.slice_scale[column] +
                           loadValues<width>(columns, column) *
                               -columns.diagonal[column]);
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

LatticeEmbedding
latticeEmbedding(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, embed);
}

const LatticeFilter&
latticeFilter(SimdTier tier, std::size_t width)
{
  const int number = width == 1 ? 0 : width == 4 ? 1 : width == 8 ? 2 : 3;
  return PCL_SEMANTIC_OF_TIER(tier, filters)[number];
}

} // namespace pcl_semantic::kernels
#endif
