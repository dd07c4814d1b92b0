/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, with PCL_SEMANTIC_TARGET its instruction set and
// PCL_SEMANTIC_LANES its width: vectors have to be of that width where they are
// written, in a template inlined later they would have been taken apart.

#define PCL_SEMANTIC_INLINE inline PCL_SEMANTIC_TARGET __attribute__((always_inline))

constexpr std::size_t lanes = PCL_SEMANTIC_LANES;
typedef float Floats __attribute__((vector_size(4 * lanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * lanes)));
typedef std::uint32_t Words __attribute__((vector_size(4 * lanes)));
typedef std::uint16_t Halves __attribute__((vector_size(2 * lanes)));
typedef float Eight __attribute__((vector_size(32)));

// Vectors anywhere in memory.
struct Unaligned {
  typedef Floats F __attribute__((aligned(4), may_alias));
  typedef Eight E __attribute__((aligned(4), may_alias));
  typedef Words W __attribute__((aligned(4), may_alias));
  typedef Halves H __attribute__((aligned(2), may_alias));
};

PCL_SEMANTIC_INLINE Floats
load(const float* from)
{
  return *reinterpret_cast<const Unaligned::F*>(from);
}

PCL_SEMANTIC_INLINE void
store(const Floats& values, float* to)
{
  *reinterpret_cast<Unaligned::F*>(to) = values;
}

PCL_SEMANTIC_INLINE void
copyHalf(const float* from, float* to)
{
  *reinterpret_cast<Unaligned::E*>(to) = *reinterpret_cast<const Unaligned::E*>(from);
}

PCL_SEMANTIC_INLINE Words
lane()
{
  Words numbers{};
  for (std::size_t k = 0; k < lanes; ++k)
    numbers[k] = std::uint32_t(k);
  return numbers;
}

// 2^v for v <= 0, to 4e-5: enough for weights of 8 bits.
PCL_SEMANTIC_INLINE Floats
powerOfTwo(const Floats& v)
{
  const float magic = 12582912.0f; // 1.5 * 2^23: a sum with it is rounded to an integer
  const Floats shifted = v + magic;
  const Floats fraction = v - (shifted - magic);
  Floats power = fraction * 0.0096181291f + 0.0555041087f;
  power = power * fraction + 0.2402265070f;
  power = power * fraction + 0.6931471806f;
  power = power * fraction + 1.0f;
  return (Floats)(((Ints)power + ((Ints)shifted << 23)) & (v >= -126.0f));
}

PCL_SEMANTIC_INLINE void
toBfloat16(const Floats& values, std::uint16_t* to)
{
  const Words bits = (Words)values;
  // To the nearest, of two equally near ones the even one.
  const Words rounded = (bits + 0x7FFF + ((bits >> 16) & 1)) >> 16;
  *reinterpret_cast<Unaligned::H*>(to) = __builtin_convertvector(rounded, Halves);
}

PCL_SEMANTIC_INLINE Floats
fromBfloat16(const std::uint16_t* from)
{
  const Halves halves = *reinterpret_cast<const Unaligned::H*>(from);
  return (Floats)(__builtin_convertvector(halves, Words) << 16);
}

// Values of some arrays at the pairs, one after the other. Most runs are short, so they
// are copied by halves of the longest one.
template <int count>
PCL_SEMANTIC_INLINE void
gather(const RunsView& view, const float* const* arrays, float* scratch,
       std::size_t stride)
{
  constexpr std::size_t half = longest_run / 2;
  const float* from[count];
  for (int a = 0; a < count; ++a)
    from[a] = arrays[a];
  const std::uint32_t* const end = view.runs + view.count;
  for (const std::uint32_t* run = view.runs; run != end; ++run) {
    const std::size_t first = *run >> run_length_bits, length = *run & run_length_mask;
    for (int a = 0; a < count; ++a)
      copyHalf(from[a] + first, scratch + std::size_t(a) * stride);
    if (length > half)
      for (int a = 0; a < count; ++a)
        copyHalf(from[a] + first + half, scratch + std::size_t(a) * stride + half);
    scratch += length;
  }
}

PCL_SEMANTIC_INLINE void
gatherAll(const RunsView& runs, const float* const* arrays, int count, float* scratch,
          std::size_t stride)
{
  for (; count >= 3; count -= 3, arrays += 3, scratch += 3 * stride)
    gather<3>(runs, arrays, scratch, stride);
  for (; count >= 2; count -= 2, arrays += 2, scratch += 2 * stride)
    gather<2>(runs, arrays, scratch, stride);
  for (; count > 0; --count, ++arrays, scratch += stride)
    gather<1>(runs, arrays, scratch, stride);
}

PCL_SEMANTIC_INLINE Floats
squared(const Floats& value)
{
  return value * value;
}

// Gathers positions and the features of the first terms.
PCL_SEMANTIC_INLINE void
gatherPoints(const PointsView& points, const RunsView& runs, int terms, float* scratch,
             std::size_t stride)
{
  gather<3>(runs, points.position, scratch, stride);
  scratch += 3 * stride;
  for (int m = 0; m < terms; ++m) {
    gatherAll(runs, points.terms[m].features, points.terms[m].dimensions, scratch,
              stride);
    scratch += std::size_t(points.terms[m].dimensions) * stride;
  }
}

// Squared distances of positions at the pairs e, e + 1, ..., and whether they are
// pairs.
PCL_SEMANTIC_INLINE Floats
squaredDistances(const PointsView& points, const RunsView& runs, const float* scratch,
                 std::size_t stride, std::size_t e, Ints& inside)
{
  Floats sum = squared(load(scratch + e) - points.position[0][runs.point]);
  sum += squared(load(scratch + stride + e) - points.position[1][runs.point]);
  sum += squared(load(scratch + 2 * stride + e) - points.position[2][runs.point]);
  inside = (sum <= points.squared_radius) &
           ((Ints)lane() < std::int32_t(runs.pairs) - std::int32_t(e));
  return sum;
}

// Values of a term at some pairs. \a features: gathered ones of the term.
PCL_SEMANTIC_INLINE Floats
evaluate(const TermView& term, std::size_t point, const float* features,
         std::size_t stride, const Floats& distance, const Ints& inside)
{
  Floats sum = distance * term.position_scale;
  for (int d = 0; d < term.dimensions; ++d)
    sum += squared(load(features + std::size_t(d) * stride) - term.features[d][point]);
  return (Floats)((Ints)powerOfTwo(-sum) & inside);
}

PCL_SEMANTIC_TARGET void
sumTerms(const PointsView& points, const RunsView& runs, float* scratch, float* sums,
         std::uint16_t* const* values)
{
  const std::size_t stride = strideOf(runs.pairs);
  gatherPoints(points, runs, points.count, scratch, stride);
  const float* features = scratch + 3 * stride;
  for (int m = 0; m < points.count; ++m) {
    const TermView term = points.terms[m];
    std::uint16_t* const to = values[m];
    Floats sum{};
    for (std::size_t e = 0; e < runs.pairs; e += lanes) {
      Ints inside;
      const Floats distance =
          squaredDistances(points, runs, scratch, stride, e, inside);
      const Floats value =
          evaluate(term, runs.point, features + e, stride, distance, inside);
      sum += value;
      toBfloat16(value, to + e);
    }
    sums[m] = 0.0f;
    for (std::size_t k = 0; k < lanes; ++k)
      sums[m] += sum[k];
    features += std::size_t(term.dimensions) * stride;
  }
}

PCL_SEMANTIC_TARGET void
makeWeights(const RunsView& runs, int terms, const float* left,
            const float* const* right, float* scratch, std::uint16_t* const* values)
{
  const std::size_t stride = strideOf(runs.pairs);
  gatherAll(runs, right, terms, scratch, stride);
  std::uint16_t* const weights = values[0];
  for (std::size_t e = 0; e < runs.pairs; e += lanes) {
    Floats sum{};
    for (int m = 0; m < terms; ++m)
      sum += fromBfloat16(values[m] + e) * load(scratch + std::size_t(m) * stride + e) *
             left[m];
    toBfloat16(sum, weights + e);
  }
  std::size_t e = 0; // no pair of the point with itself
  for (std::size_t r = 0; r < runs.count; ++r) {
    const std::size_t offset = runs.point - (runs.runs[r] >> run_length_bits);
    const std::size_t length = runs.runs[r] & run_length_mask;
    if (offset < length)
      weights[e + offset] = 0;
    e += length;
  }
}

// The product for some blocks of rows at a time.
template <int blocks>
PCL_SEMANTIC_INLINE void
addRows(const std::uint32_t* neighbours, const float* weights, std::size_t pairs,
        const float* values, std::size_t rows, float* result)
{
  Floats even[blocks], odd[blocks];
  for (int b = 0; b < blocks; ++b) {
    even[b] = load(result + b * lanes);
    odd[b] = Floats{};
  }
  for (std::size_t e = 0; e < pairs; e += 2) { // an even number, by a weight of 0
    const float* const first = values + neighbours[e] * rows;
    const float* const second = values + neighbours[e + 1] * rows;
    for (int b = 0; b < blocks; ++b) {
      even[b] += load(first + b * lanes) * weights[e];
      odd[b] += load(second + b * lanes) * weights[e + 1];
    }
  }
  for (int b = 0; b < blocks; ++b)
    store(even[b] + odd[b], result + b * lanes);
}

PCL_SEMANTIC_TARGET void
addProduct(const RunsView& runs, const std::uint16_t* weights, const float* values,
           std::size_t rows, float* scratch, float* result)
{
  auto* const neighbours =
      reinterpret_cast<std::uint32_t*>(scratch + strideOf(runs.pairs));
  std::uint32_t* next = neighbours;
  for (std::size_t r = 0; r < runs.count; ++r) {
    for (std::size_t k = 0; k < longest_run; k += lanes)
      *reinterpret_cast<Unaligned::W*>(next + k) =
          lane() + (runs.runs[r] >> run_length_bits) + std::uint32_t(k);
    next += runs.runs[r] & run_length_mask;
  }
  for (std::size_t e = 0; e < runs.pairs; e += lanes)
    store(fromBfloat16(weights + e), scratch + e);
  std::size_t pairs = runs.pairs;
  if (pairs % 2) {
    scratch[pairs] = 0.0f;
    neighbours[pairs++] = std::uint32_t(runs.point);
  }
  constexpr int blocks = 16 / lanes;
  std::size_t row = 0;
  for (; lanes > 4 && row + 32 <= rows; row += 32)
    addRows<2 * blocks>(neighbours, scratch, pairs, values + row, rows, result + row);
  for (; row < rows; row += 16)
    addRows<blocks>(neighbours, scratch, pairs, values + row, rows, result + row);
}

constexpr TruncatedSums loops = {sumTerms, makeWeights, addProduct};

#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
