/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, behind float_lanes_tier.hpp: values of the terms and weights.

// The first arrays of the points at the pairs of a group, one after the other. Most
// runs are short, so they are copied by halves of the longest one.
template <int fixed>
PCL_SEMANTIC_INLINE void
gather(const PointsView& points, const GroupView& group, std::size_t arrays,
       float* scratch)
{
  constexpr std::size_t half = longest_run / 2;
  const std::size_t from_stride = points.stride, stride = scratchStride(group.length);
  const float* const values = points.arrays;
  const std::size_t count = fixed > 0 ? std::size_t(fixed) : arrays;
  const std::uint32_t* const end = group.runs + group.count;
  for (const std::uint32_t* run = group.runs; run != end; ++run) {
    const float* const from = values + (*run >> run_length_bits);
    const std::size_t length = *run & run_length_mask;
    for (std::size_t a = 0; a < count; ++a)
      copyHalf(from + a * from_stride, scratch + a * stride);
    if (length > half)
      for (std::size_t a = 0; a < count; ++a)
        copyHalf(from + a * from_stride + half, scratch + a * stride + half);
    scratch += length;
  }
}

// Behind the last pair, up to a whole block, lies a point beyond every radius.
PCL_SEMANTIC_INLINE void
gatherArrays(const PointsView& points, const GroupView& group, std::size_t arrays,
             float* scratch)
{
  if (arrays == 6)
    gather<6>(points, group, arrays, scratch);
  else if (arrays == 8)
    gather<8>(points, group, arrays, scratch);
  else
    gather<0>(points, group, arrays, scratch);
  std::fill(scratch + group.length, scratch + strideOf(group.length), 1e30f);
}

PCL_SEMANTIC_INLINE Floats
squared(const Floats& value)
{
  return value * value;
}

// log2 of the part of positions in the values of a term.
PCL_SEMANTIC_INLINE Floats
exponentOf(const Floats& squared_distance, float squared_radius, float scale)
{
  return squared_distance <= squared_radius ? squared_distance * -scale
                                            : Floats{} - 1e30f;
}

PCL_SEMANTIC_INLINE Floats
squaredDistance(const float* position, const float* gathered, std::size_t stride)
{
  Floats sum = squared(load(gathered) - position[0]);
  sum += squared(load(gathered + stride) - position[1]);
  return sum + squared(load(gathered + 2 * stride) - position[2]);
}

// A point of the usual two terms, smoothness and appearance of three colours, in
// variables that the compiler holds in registers.
struct UsualPoint {
  float position[3], colour[3], scale[2], left[2], squared_radius;

  PCL_SEMANTIC_INLINE
  UsualPoint(const PointsView& points, std::size_t point)
      : squared_radius(points.squared_radius)
  {
    for (std::size_t k = 0; k < 3; ++k) {
      position[k] = points.arrays[k * points.stride + point];
      colour[k] = points.arrays[(3 + k) * points.stride + point];
    }
    for (std::size_t m = 0; m < 2; ++m) {
      scale[m] = points.terms[m].position_scale;
      left[m] = points.left[m][point];
    }
  }

  static bool
  fits(const PointsView& points)
  {
    return points.count == 2 && points.terms[0].dimensions == 0 &&
           points.terms[1].dimensions == 3;
  }

  // Values of both terms at some pairs, of what was gathered of them.
  PCL_SEMANTIC_INLINE void
  evaluate(const float* gathered, std::size_t stride, Floats& smoothness,
           Floats& appearance) const
  {
    const Floats distance = squaredDistance(position, gathered, stride);
    smoothness = powerOfTwo(exponentOf(distance, squared_radius, scale[0]));
    Floats exponent = exponentOf(distance, squared_radius, scale[1]);
    for (std::size_t k = 0; k < 3; ++k)
      exponent -= squared(load(gathered + (3 + k) * stride) - colour[k]);
    appearance = powerOfTwo(exponent);
  }

  PCL_SEMANTIC_INLINE Floats
  weights(const float* gathered, std::size_t stride) const
  {
    Floats smoothness, appearance;
    evaluate(gathered, stride, smoothness, appearance);
    return smoothness * (load(gathered + 6 * stride) * left[0]) +
           appearance * (load(gathered + 7 * stride) * left[1]);
  }
};

// A point of any terms.
struct AnyPoint {
  const PointsView& points;
  std::size_t point;

  PCL_SEMANTIC_INLINE
  AnyPoint(const PointsView& all, std::size_t number) : points(all), point(number) {}

  PCL_SEMANTIC_INLINE Floats
  evaluate(int m, const float* gathered, std::size_t stride) const
  {
    const TermView& term = points.terms[m];
    const float* const own = points.arrays + point;
    const float position[] = {own[0], own[points.stride], own[2 * points.stride]};
    Floats exponent = exponentOf(squaredDistance(position, gathered, stride),
                                 points.squared_radius, term.position_scale);
    for (std::size_t a = term.first; a < term.first + std::size_t(term.dimensions); ++a)
      exponent -= squared(load(gathered + a * stride) - own[a * points.stride]);
    return powerOfTwo(exponent);
  }

  PCL_SEMANTIC_INLINE Floats
  weights(const float* gathered, std::size_t stride) const
  {
    Floats sum{};
    for (int m = 0; m < points.count; ++m)
      sum += evaluate(m, gathered, stride) *
             (load(gathered + (points.features_end + std::size_t(m)) * stride) *
              points.left[m][point]);
    return sum;
  }
};

PCL_SEMANTIC_TARGET void
sumTerms(const PointsView& points, const GroupView& group, float* scratch, float* sums)
{
  const std::size_t stride = scratchStride(group.length);
  gatherArrays(points, group, points.features_end, scratch);
  const bool usual = UsualPoint::fits(points);
  for (int p = 0; p < group.points; ++p) {
    const std::size_t point = group.point + std::size_t(p);
    if (usual) {
      const UsualPoint center(points, point);
      Floats totals[2] = {}, smoothness, appearance;
      for (std::size_t e = 0; e < group.length; e += lanes) {
        center.evaluate(scratch + e, stride, smoothness, appearance);
        totals[0] += smoothness;
        totals[1] += appearance;
      }
      sums[p] = sumOf(totals[0]);
      sums[most_points + p] = sumOf(totals[1]);
      continue;
    }
    for (int m = 0; m < points.count; ++m) {
      Floats total{};
      for (std::size_t e = 0; e < group.length; e += lanes)
        total += AnyPoint(points, point).evaluate(m, scratch + e, stride);
      sums[m * most_points + p] = sumOf(total);
    }
  }
}

// No pair of a point with itself.
PCL_SEMANTIC_INLINE void
clearOwnWeights(const GroupView& group, std::uint32_t* weights)
{
  constexpr std::size_t half = pair_block / 2;
  const std::size_t end = group.point + std::size_t(group.points);
  std::size_t begin = 0; // of the run, in the pairs of a point
  for (std::size_t r = 0; r < group.count; ++r) {
    const std::size_t first = group.runs[r] >> run_length_bits;
    const std::size_t length = group.runs[r] & run_length_mask;
    if (first < end && first + length > group.point)
      for (std::size_t p = 0; p < std::size_t(group.points); ++p)
        if (group.point + p - first < length) {
          const std::size_t e = begin + group.point + p - first;
          weights[p * strideOf(group.length) / 2 + e / pair_block * half + e % half] &=
              e % pair_block < half ? 0xFFFF0000u : 0x0000FFFFu;
        }
    begin += length;
  }
}

// \a line: room for the weights before they are packed
template <typename Point>
PCL_SEMANTIC_INLINE void
makeWeightsOf(const Point& point, const float* gathered, std::size_t stride,
              std::size_t length, float* line, std::uint32_t* weights)
{
  constexpr std::size_t half = pair_block / 2;
  for (std::size_t e = 0; e < length; e += lanes)
    store(point.weights(gathered + e, stride), line + e);
  for (std::size_t e = 0; e < length; e += pair_block)
    for (std::size_t k = e; k < e + half; k += lanes, weights += lanes)
      *reinterpret_cast<Unaligned::W*>(weights) =
          pack(load(line + k), load(line + k + half));
}

PCL_SEMANTIC_TARGET void
makeWeights(const PointsView& points, const GroupView& group, float* scratch,
            std::uint32_t* weights)
{
  const std::size_t stride = scratchStride(group.length), length = group.length;
  const std::size_t arrays = points.features_end + std::size_t(points.count);
  gatherArrays(points, group, arrays, scratch);
  float* const line = scratch + arrays * stride;
  std::fill(line + length / lanes * lanes, line + strideOf(length), 0.0f);
  const bool usual = UsualPoint::fits(points);
  for (std::size_t p = 0; p < std::size_t(group.points); ++p) {
    std::uint32_t* const to = weights + p * strideOf(length) / 2;
    const std::size_t number = group.point + p;
    if (usual)
      makeWeightsOf(UsualPoint(points, number), scratch, stride, length, line, to);
    else
      makeWeightsOf(AnyPoint(points, number), scratch, stride, length, line, to);
  }
  clearOwnWeights(group, weights);
}
