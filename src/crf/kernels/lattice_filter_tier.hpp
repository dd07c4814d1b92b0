/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, with PCL_SEMANTIC_TARGET its instruction set and
// PCL_SEMANTIC_LANES its width: vectors have to be of that width where they are
// written. V is a vector or a float, and a row has some parts of it.

template <typename V>
PCL_SEMANTIC_TARGET inline __attribute__((always_inline)) void
load(const float* from, V& to)
{
  __builtin_memcpy(&to, from, sizeof(V));
}

template <typename V>
PCL_SEMANTIC_TARGET inline __attribute__((always_inline)) void
store(const V& from, float* to)
{
  __builtin_memcpy(to, &from, sizeof(V));
}

// Reads a whole row of values; what lies behind the rows of interest does no harm, but
// memory must not end there.
template <typename V, int parts>
PCL_SEMANTIC_TARGET inline __attribute__((always_inline)) void
loadValues(const LatticeColumns& columns, std::size_t column, V* to)
{
  constexpr std::size_t lanes = sizeof(V) / sizeof(float);
  const float* from = columns.values + column * columns.values_stride;
  float last[parts * lanes];
  if (from + parts * lanes > columns.end) {
    for (std::size_t r = 0; r < parts * lanes; ++r)
      last[r] = r < columns.rows ? from[r] : 0.0f;
    from = last;
  }
  for (int b = 0; b < parts; ++b)
    load(from + std::size_t(b) * lanes, to[b]);
}

// Columns are not in the order of memory: to be fetched some points ahead.
PCL_SEMANTIC_TARGET inline __attribute__((always_inline)) std::size_t
laterColumn(const LatticePoints& points, std::size_t i)
{
  const std::size_t later = i + points_ahead;
  return std::size_t(points.columns[later < points.count ? later : i]);
}

template <typename V, int parts>
PCL_SEMANTIC_TARGET void
splat(const LatticePoints& points, const LatticeColumns& columns, float* lattice)
{
  constexpr std::size_t lanes = sizeof(V) / sizeof(float), width = parts * lanes;
  for (std::size_t r = 0; r < points.partials * width; ++r)
    lattice[points.first_partial * width + r] = 0.0f;
  std::size_t begun = points.first_row;
  for (std::size_t begin = 0; begin < points.count; begin += row_end_points) {
    // Rows are begun shortly before they are needed: they are in the fast cache then.
    const auto row_end = std::size_t(points.row_ends[begin / row_end_points]);
    for (; begun < row_end; ++begun) {
      __builtin_prefetch(lattice + (begun + rows_ahead) * width, 1);
      for (std::size_t r = 0; r < width; ++r)
        lattice[begun * width + r] = 0.0f;
    }
    const std::size_t end =
        begin + row_end_points < points.count ? begin + row_end_points : points.count;
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = std::size_t(points.columns[i]);
      __builtin_prefetch(columns.values +
                         laterColumn(points, i) * columns.values_stride);
      V value[parts];
      loadValues<V, parts>(columns, column, value);
      for (int b = 0; b < parts; ++b)
        value[b] = value[b] * columns.splat_scale[column];
      for (std::size_t k = i * points.corners; k < (i + 1) * points.corners; ++k) {
        float* const row = lattice + std::size_t(points.rows[k]) * width;
        for (int b = 0; b < parts; ++b) {
          V sum;
          load(row + std::size_t(b) * lanes, sum);
          store(V(sum + value[b] * points.weights[k]), row + std::size_t(b) * lanes);
        }
      }
    }
  }
}

template <typename V, int parts>
PCL_SEMANTIC_TARGET void
merge(const std::int32_t* vertices, std::size_t count, const std::uint32_t* ends,
      const std::int32_t* partials, float* lattice)
{
  constexpr std::size_t lanes = sizeof(V) / sizeof(float), width = parts * lanes;
  for (std::size_t m = 0; m < count; ++m) {
    float* const row = lattice + std::size_t(vertices[m]) * width;
    const std::size_t later = m + rows_ahead < count ? m + rows_ahead : m;
    __builtin_prefetch(lattice + std::size_t(vertices[later]) * width, 1);
    __builtin_prefetch(lattice + std::size_t(partials[ends[later] - 1]) * width);
    V sum[parts], part;
    for (int b = 0; b < parts; ++b)
      load(row + std::size_t(b) * lanes, sum[b]);
    for (std::uint32_t p = ends[std::ptrdiff_t(m) - 1]; p < ends[m]; ++p)
      for (int b = 0; b < parts; ++b) {
        load(lattice + std::size_t(partials[p]) * width + std::size_t(b) * lanes, part);
        sum[b] = sum[b] + part;
      }
    for (int b = 0; b < parts; ++b)
      store(sum[b], row + std::size_t(b) * lanes);
  }
}

template <typename V, int parts>
PCL_SEMANTIC_TARGET void
blur(const std::int32_t* steps, std::size_t count, float* lattice)
{
  constexpr std::size_t lanes = sizeof(V) / sizeof(float), width = parts * lanes;
  const auto rowOf = [&](std::size_t step) __attribute__((always_inline))
  {
    return lattice + std::size_t(steps[step] & ~run_end) * width;
  };
  // Runs are of a few vertices: a branch at their ends would be mispredicted.
  const float share[2] = {0.5f, 0.0f};
  float from_back = 0.0f;
  V back[parts], here[parts], ahead[parts];
  for (int b = 0; b < parts; ++b) {
    back[b] = V{};
    load(rowOf(0) + std::size_t(b) * lanes, here[b]);
  }
  for (std::size_t t = 0; t < count; ++t) {
    __builtin_prefetch(rowOf(t + steps_ahead), 1);
    float* const row = rowOf(t);
    const float* const next = rowOf(t + 1);
    const float from_ahead = share[std::uint32_t(steps[t]) >> 31];
    for (int b = 0; b < parts; ++b) {
      load(next + std::size_t(b) * lanes, ahead[b]);
      store(V(here[b] + (back[b] * from_back + ahead[b] * from_ahead)),
            row + std::size_t(b) * lanes);
      back[b] = here[b];
      here[b] = ahead[b];
    }
    from_back = from_ahead;
  }
}

// result += added, for the rows of interest.
template <typename V, int parts>
PCL_SEMANTIC_TARGET inline __attribute__((always_inline)) void
addToResult(const LatticeColumns& columns, std::size_t column, const V* added)
{
  constexpr std::size_t lanes = sizeof(V) / sizeof(float), width = parts * lanes;
  float* const result = columns.result + column * columns.result_stride;
  if (columns.rows == width) {
    for (int b = 0; b < parts; ++b) {
      V sum;
      load(result + std::size_t(b) * lanes, sum);
      store(V(sum + added[b]), result + std::size_t(b) * lanes);
    }
    return;
  }
  float some[width];
  for (int b = 0; b < parts; ++b)
    store(added[b], some + std::size_t(b) * lanes);
  for (std::size_t r = 0; r < columns.rows; ++r)
    result[r] = result[r] + some[r];
}

template <typename V, int parts, int halves>
PCL_SEMANTIC_TARGET void
slice(const LatticePoints& points, const LatticeColumns& columns, float* lattice,
      std::size_t half)
{
  constexpr std::size_t lanes = sizeof(V) / sizeof(float), width = parts * lanes;
  V part;
  for (int h = 0; h < halves; ++h)
    for (std::size_t p = 0; p < points.partials; ++p)
      for (std::size_t r = std::size_t(h) * half; r < std::size_t(h) * half + width;
           r += lanes) {
        load(lattice + std::size_t(points.represents[p]) * width + r, part);
        store(part, lattice + (points.first_partial + p) * width + r);
      }
  for (std::size_t i = 0; i < points.count; ++i) {
    const auto column = std::size_t(points.columns[i]);
    const std::size_t later = laterColumn(points, i);
    __builtin_prefetch(columns.values + later * columns.values_stride);
    __builtin_prefetch(columns.result + later * columns.result_stride, 1);
    if (columns.active && !columns.active[column])
      continue;
    V sum[parts], value[parts];
    for (int b = 0; b < parts; ++b)
      sum[b] = V{};
    for (std::size_t k = i * points.corners; k < (i + 1) * points.corners; ++k) {
      const float* const row = lattice + std::size_t(points.rows[k]) * width;
      for (int b = 0; b < parts; ++b) {
        load(row + std::size_t(b) * lanes, part);
        if (halves == 2) {
          V other;
          load(row + half + std::size_t(b) * lanes, other);
          part = (part + other) * 0.5f;
        }
        sum[b] = sum[b] + part * points.weights[k];
      }
    }
    loadValues<V, parts>(columns, column, value);
    for (int b = 0; b < parts; ++b)
      sum[b] =
          sum[b] * columns.slice_scale[column] - value[b] * columns.diagonal[column];
    addToResult<V, parts>(columns, column, sum);
  }
}

template <typename V, int parts, int halves>
constexpr LatticeFilter loops = {splat<V, parts>, merge<V, parts>, blur<V, parts>,
                                 slice<V, parts, halves>};

typedef float Four __attribute__((vector_size(16)));
#if PCL_SEMANTIC_LANES == 4
constexpr LatticeFilter filters[2][4] = {
    {loops<float, 1, 1>, loops<Four, 1, 1>, loops<Four, 2, 1>, loops<Four, 4, 1>},
    {loops<float, 1, 2>, loops<Four, 1, 2>, loops<Four, 2, 2>, loops<Four, 4, 2>}};
#else
typedef float Eight __attribute__((vector_size(32)));
typedef float Lanes __attribute__((vector_size(4 * PCL_SEMANTIC_LANES)));
constexpr int lane_parts = 16 / PCL_SEMANTIC_LANES;
constexpr LatticeFilter filters[2][4] = {
    {loops<float, 1, 1>, loops<Four, 1, 1>, loops<Eight, 1, 1>,
     loops<Lanes, lane_parts, 1>},
    {loops<float, 1, 2>, loops<Four, 1, 2>, loops<Eight, 1, 2>,
     loops<Lanes, lane_parts, 2>}};
#endif

#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
