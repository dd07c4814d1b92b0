/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, behind float_lanes_tier.hpp: values of the terms and weights.

// Some arrays of the points at the pairs of a group, one after the other. Most runs are
// short, so they are copied by halves of the longest one.
template <int fixed>
PCL_SEMANTIC_INLINE void
gather(const PointsView& points, const GroupView& group, std::size_t first,
       std::size_t any, float* scratch)
{
  constexpr std::size_t half = longest_run / 2;
  const std::size_t from_stride = points.stride, stride = scratchStride(group.length);
  const float* const arrays = points.arrays + first * from_stride;
  const std::size_t count = fixed > 0 ? std::size_t(fixed) : any;
  const std::uint32_t* const end = group.runs + group.count;
  for (const std::uint32_t* run = group.runs; run != end; ++run) {
    const float* const from = arrays + (*run >> run_length_bits);
    const std::size_t length = *run & run_length_mask;
    for (std::size_t a = 0; a < count; ++a)
      copyHalf(from + a * from_stride, scratch + a * stride);
    if (length > half)
      for (std::size_t a = 0; a < count; ++a)
        copyHalf(from + a * from_stride + half, scratch + a * stride + half);
    scratch += length;
  }
}

PCL_SEMANTIC_INLINE void
gatherArrays(const PointsView& points, const GroupView& group, std::size_t first,
             std::size_t count, float* scratch)
{
  if (count == 6)
    gather<6>(points, group, first, count, scratch);
  else if (count == 5)
    gather<5>(points, group, first, count, scratch);
  else
    gather<0>(points, group, first, count, scratch);
}

PCL_SEMANTIC_INLINE Floats
squared(const Floats& value)
{
  return value * value;
}

// Smoothness and appearance of three colours: these have loops of their own.
PCL_SEMANTIC_INLINE bool
areUsual(const PointsView& points)
{
  return points.count == 2 && points.terms[0].dimensions == 0 &&
         points.terms[1].dimensions == 3;
}

// The colours of a point in variables that the compiler holds in registers.
struct Colour {
  float value[3];

  PCL_SEMANTIC_INLINE
  Colour(const PointsView& points, std::size_t point)
  {
    for (std::size_t k = 0; k < 3; ++k)
      value[k] = points.arrays[(3 + k) * points.stride + point];
  }

  // What the colours at some pairs leave of the values there.
  PCL_SEMANTIC_INLINE Floats
  part(const float* gathered, std::size_t stride) const
  {
    Floats sum = squared(load(gathered) - value[0]);
    sum += squared(load(gathered + stride) - value[1]);
    return powerOfTwo(-(sum + squared(load(gathered + 2 * stride) - value[2])));
  }
};

// The same for the features of any term.
PCL_SEMANTIC_INLINE Floats
featurePart(const PointsView& points, int m, std::size_t point, const float* gathered,
            std::size_t stride)
{
  const TermView& term = points.terms[m];
  Floats sum{};
  for (std::size_t d = 0; d < std::size_t(term.dimensions); ++d)
    sum += squared(load(gathered + (term.first - 3 + d) * stride) -
                   points.arrays[(term.first + d) * points.stride + point]);
  return powerOfTwo(-sum);
}

// What the positions at some pairs leave: nothing beyond the radius.
PCL_SEMANTIC_INLINE void
positionParts(const PointsView& points, std::size_t point, const float* gathered,
              std::size_t stride, std::size_t length, float* line)
{
  const float x = points.arrays[point], y = points.arrays[points.stride + point],
              z = points.arrays[2 * points.stride + point];
  const float radius = points.squared_radius, scale = -points.position_scale;
  for (std::size_t e = 0; e < length; e += lanes) {
    Floats sum = squared(load(gathered + e) - x);
    sum += squared(load(gathered + stride + e) - y);
    sum += squared(load(gathered + 2 * stride + e) - z);
    store(powerOfTwo(sum <= radius ? sum * scale : Floats{} - 1e30f), line + e);
  }
}

PCL_SEMANTIC_TARGET void
sumTerms(const PointsView& points, const GroupView& group, float* scratch, float* sums,
         std::uint32_t* weights)
{
  const std::size_t stride = scratchStride(group.length), length = group.length;
  gatherArrays(points, group, 0, points.features_end, scratch);
  // Behind the last pair, up to a whole block, lies a point beyond every radius.
  std::fill(scratch + length, scratch + strideOf(length), 1e30f);
  const float* const features = scratch + 3 * stride;
  float* const line = scratch + points.features_end * stride;
  std::fill(line + length, line + strideOf(length), 0.0f);
  const bool usual = areUsual(points);
  for (std::size_t p = 0; p < std::size_t(group.points); ++p) {
    const std::size_t point = group.point + p;
    positionParts(points, point, scratch, stride, length, line);
    if (usual) {
      const Colour colour(points, point);
      Floats totals[2] = {};
      for (std::size_t e = 0; e < length; e += lanes) {
        const Floats part = load(line + e);
        totals[0] += part;
        totals[1] += part * colour.part(features + e, stride);
      }
      sums[p] = sumOf(totals[0]);
      sums[most_points + p] = sumOf(totals[1]);
    }
    else
      for (int m = 0; m < points.count; ++m) {
        Floats total{};
        for (std::size_t e = 0; e < length; e += lanes)
          total += load(line + e) * featurePart(points, m, point, features + e, stride);
        sums[std::size_t(m) * most_points + p] = sumOf(total);
      }
    packLine(line, length, weights + p * strideOf(length) / 2);
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

PCL_SEMANTIC_TARGET void
makeWeights(const PointsView& points, const GroupView& group, float* scratch,
            std::uint32_t* weights)
{
  const std::size_t stride = scratchStride(group.length), length = group.length;
  const std::size_t features = points.features_end - 3;
  const auto count = std::size_t(points.count);
  gatherArrays(points, group, 3, features + count, scratch);
  const float* const right = scratch + features * stride;
  float* const line = scratch + (features + count) * stride;
  const bool usual = areUsual(points);
  for (std::size_t p = 0; p < std::size_t(group.points); ++p) {
    std::uint32_t* const words = weights + p * strideOf(length) / 2;
    const std::size_t point = group.point + p;
    unpackLine(words, length, line);
    if (usual) {
      const Colour colour(points, point);
      const float smoothness = points.left[0][point],
                  appearance = points.left[1][point];
      for (std::size_t e = 0; e < length; e += lanes)
        store(load(line + e) * (load(right + e) * smoothness +
                                load(right + stride + e) * appearance *
                                    colour.part(scratch + e, stride)),
              line + e);
    }
    else
      for (std::size_t e = 0; e < length; e += lanes) {
        Floats sum{};
        for (std::size_t m = 0; m < count; ++m)
          sum += load(right + m * stride + e) * points.left[m][point] *
                 featurePart(points, int(m), point, scratch + e, stride);
        store(load(line + e) * sum, line + e);
      }
    std::fill(line + length, line + strideOf(length), 0.0f); // no numbers, maybe
    packLine(line, length, words);
  }
  clearOwnWeights(group, weights);
}
