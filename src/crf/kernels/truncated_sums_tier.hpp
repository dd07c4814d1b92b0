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
  return (Floats)(((Words)power + ((Words)shifted << 23)) & (Words)(v >= -126.0f));
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
gather(const GroupView& group, const float* const* arrays, float* scratch,
       std::size_t stride)
{
  constexpr std::size_t half = longest_run / 2;
  const float* from[count];
  for (int a = 0; a < count; ++a)
    from[a] = arrays[a];
  const std::uint32_t* const end = group.runs + group.count;
  for (const std::uint32_t* run = group.runs; run != end; ++run) {
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
gatherAll(const GroupView& group, const float* const* arrays, int count, float* scratch,
          std::size_t stride)
{
  for (; count >= 3; count -= 3, arrays += 3, scratch += 3 * stride)
    gather<3>(group, arrays, scratch, stride);
  for (; count >= 2; count -= 2, arrays += 2, scratch += 2 * stride)
    gather<2>(group, arrays, scratch, stride);
  for (; count > 0; --count, ++arrays, scratch += stride)
    gather<1>(group, arrays, scratch, stride);
}

PCL_SEMANTIC_INLINE Floats
squared(const Floats& value)
{
  return value * value;
}

// Squared distances of positions from a point; beyond the radius very large ones.
PCL_SEMANTIC_INLINE void
squaredDistances(const PointsView& points, std::size_t point, std::size_t length,
                 const float* positions, std::size_t stride, float* distances)
{
  for (std::size_t e = 0; e < length; e += lanes) {
    Floats sum = squared(load(positions + e) - points.position[0][point]);
    sum += squared(load(positions + stride + e) - points.position[1][point]);
    sum += squared(load(positions + 2 * stride + e) - points.position[2][point]);
    const Ints inside = (sum <= points.squared_radius) &
                        ((Ints)lane() < std::int32_t(length) - std::int32_t(e));
    store(inside ? sum : Floats{} + 1e30f, distances + e);
  }
}

// Values of a term at the pairs of a point. \a features: gathered ones of the term.
template <int dimensions>
PCL_SEMANTIC_INLINE float
evaluate(const TermView& term, std::size_t point, std::size_t length,
         const float* features, std::size_t stride, const float* distances,
         std::uint16_t* values)
{
  Floats total{};
  const int count = dimensions >= 0 ? dimensions : term.dimensions;
  for (std::size_t e = 0; e < length; e += lanes) {
    Floats sum = load(distances + e) * term.position_scale;
    for (int d = 0; d < count; ++d)
      sum += squared(load(features + std::size_t(d) * stride + e) -
                     term.features[d][point]);
    const Floats value = powerOfTwo(-sum);
    total += value;
    toBfloat16(value, values + e);
  }
  float result = 0.0f;
  for (std::size_t k = 0; k < lanes; ++k)
    result += total[k];
  return result;
}

PCL_SEMANTIC_TARGET void
sumTerms(const PointsView& points, const GroupView& group, float* scratch, float* sums,
         std::uint16_t* const* values)
{
  const std::size_t stride = scratchStride(group.length);
  float* const distances = scratch;
  float* const positions = scratch + stride;
  float* const features = positions + 3 * stride;
  gather<3>(group, points.position, positions, stride);
  float* next = features;
  for (int m = 0; m < points.count; ++m) {
    gatherAll(group, points.terms[m].features, points.terms[m].dimensions, next,
              stride);
    next += std::size_t(points.terms[m].dimensions) * stride;
  }
  for (int p = 0; p < group.points; ++p) {
    const std::size_t point = group.point + std::size_t(p);
    squaredDistances(points, point, group.length, positions, stride, distances);
    next = features;
    for (int m = 0; m < points.count; ++m) {
      const TermView term = points.terms[m];
      std::uint16_t* const to = values[m] + std::size_t(p) * strideOf(group.length);
      float& sum = sums[m * most_points + p];
      if (term.dimensions == 0)
        sum = evaluate<0>(term, point, group.length, next, stride, distances, to);
      else if (term.dimensions == 3)
        sum = evaluate<3>(term, point, group.length, next, stride, distances, to);
      else
        sum = evaluate<-1>(term, point, group.length, next, stride, distances, to);
      next += std::size_t(term.dimensions) * stride;
    }
  }
}

PCL_SEMANTIC_TARGET void
makeWeights(const GroupView& group, int terms, const float* const* left,
            const float* const* right, float* scratch, std::uint16_t* const* values)
{
  const std::size_t stride = scratchStride(group.length);
  gatherAll(group, right, terms, scratch, stride);
  for (int p = 0; p < group.points; ++p) {
    const std::size_t begin = std::size_t(p) * strideOf(group.length);
    for (std::size_t e = 0; e < group.length; e += lanes) {
      Floats sum{};
      for (int m = 0; m < terms; ++m)
        sum += fromBfloat16(values[m] + begin + e) *
               load(scratch + std::size_t(m) * stride + e) *
               left[m][group.point + std::size_t(p)];
      toBfloat16(sum, values[0] + begin + e);
    }
  }
  const std::size_t end = group.point + std::size_t(group.points);
  std::size_t e = 0; // no pair of a point with itself
  for (std::size_t r = 0; r < group.count; ++r) {
    const std::size_t first = group.runs[r] >> run_length_bits;
    const std::size_t length = group.runs[r] & run_length_mask;
    if (first < end && first + length > group.point)
      for (std::size_t p = 0; p < std::size_t(group.points); ++p)
        if (group.point + p - first < length)
          values[0][p * strideOf(group.length) + e + group.point + p - first] = 0;
    e += length;
  }
}

// The product for some points and some blocks of rows at a time.
template <int points, int blocks>
PCL_SEMANTIC_INLINE void
addRows(const std::uint32_t* neighbours, const float* weights, std::size_t stride,
        std::size_t length, const float* values, std::size_t rows, float* result)
{
  Floats sums[points][blocks];
  for (int p = 0; p < points; ++p)
    for (int b = 0; b < blocks; ++b)
      sums[p][b] = load(result + std::size_t(p) * rows + b * lanes);
  for (std::size_t e = 0; e < length; ++e) {
    const float* const from = values + neighbours[e] * rows;
    for (int b = 0; b < blocks; ++b) {
      const Floats value = load(from + b * lanes);
      for (int p = 0; p < points; ++p)
        sums[p][b] += value * weights[std::size_t(p) * stride + e];
    }
  }
  for (int p = 0; p < points; ++p)
    for (int b = 0; b < blocks; ++b)
      store(sums[p][b], result + std::size_t(p) * rows + b * lanes);
}

PCL_SEMANTIC_TARGET void
addProduct(const GroupView& group, const std::uint16_t* weights, const float* values,
           std::size_t rows, float* scratch, float* result)
{
  const std::size_t stride = scratchStride(group.length);
  auto* const neighbours =
      reinterpret_cast<std::uint32_t*>(scratch + most_points * stride);
  std::uint32_t* next = neighbours;
  for (std::size_t r = 0; r < group.count; ++r) {
    for (std::size_t k = 0; k < longest_run; k += lanes)
      *reinterpret_cast<Unaligned::W*>(next + k) =
          lane() + (group.runs[r] >> run_length_bits) + std::uint32_t(k);
    next += group.runs[r] & run_length_mask;
  }
  for (std::size_t p = 0; p < std::size_t(group.points); ++p)
    for (std::size_t e = 0; e < group.length; e += lanes)
      store(fromBfloat16(weights + p * strideOf(group.length) + e),
            scratch + p * stride + e);
  constexpr int blocks = lanes > 4 ? 16 / lanes : 2;
  for (std::size_t row = 0; row < rows; row += blocks * lanes) {
    const float* const from = values + row;
    float* const to = result + row;
    switch (group.points) {
    case 4:
      addRows<4, blocks>(neighbours, scratch, stride, group.length, from, rows, to);
      break;
    case 3:
      addRows<3, blocks>(neighbours, scratch, stride, group.length, from, rows, to);
      break;
    case 2:
      addRows<2, blocks>(neighbours, scratch, stride, group.length, from, rows, to);
      break;
    default:
      addRows<1, blocks>(neighbours, scratch, stride, group.length, from, rows, to);
    }
  }
}

constexpr TruncatedSums loops = {sumTerms, makeWeights, addProduct};

#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
