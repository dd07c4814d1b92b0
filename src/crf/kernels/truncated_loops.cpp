// SPDX-License-Identifier: BSD-3-Clause
#include "truncated_loops.h"
#include "core/simd_choice.h"

#include <algorithm>

#define HWY_TARGET_INCLUDE "crf/kernels/truncated_loops.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// For identical bits in every tier, products are not fused with sums, and the order of
// sums does not depend on the number of lanes.
HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t half_block = pair_block / 2; // as many floats as a sum has lanes

constexpr hn::CappedTag<float, half_block> d;
constexpr hn::RebindToUnsigned<decltype(d)> du;
constexpr hn::RebindToSigned<decltype(d)> di;
constexpr std::size_t lanes = hn::MaxLanes(d);
constexpr std::size_t vectors = half_block / lanes;
using Floats = hn::Vec<decltype(d)>;
using Words = hn::Vec<decltype(du)>;

std::size_t
findRuns(const NearRowsView& rows, std::int32_t first, std::int32_t last,
         std::uint32_t* runs)
{
  const auto* const table = reinterpret_cast<const std::int32_t*>(rows.starts);
  std::size_t found = 0;
  for (std::size_t r = 0; r < rows.count; r += lanes) {
    const auto starts = hn::LoadU(di, rows.first_starts + r);
    const auto cells = hn::LoadU(di, rows.cells + r);
    const auto width = hn::LoadU(di, rows.widths + r);
    const auto begin = hn::LoadU(di, rows.first_cells + r);
    // In a row, before a cell or before its end.
    const auto pointsBefore = [&](auto cell) HWY_ATTR {
      const auto inside = hn::Max(hn::Zero(di), hn::Min(cells, cell));
      return hn::GatherIndex(di, table, hn::Add(starts, inside));
    };
    const auto point = pointsBefore(hn::Sub(hn::Sub(hn::Set(di, first), begin), width));
    const auto end =
        pointsBefore(hn::Add(hn::Sub(hn::Set(di, last + 1), begin), width));
    const auto length = hn::Sub(end, point);
    if (!hn::AllFalse(di, hn::Gt(length, hn::Set(di, longest_run))))
      return run_too_long;
    const auto packed =
        hn::BitCast(du, hn::Or(hn::ShiftLeft<run_length_bits>(point), length));
    if (HWY_TARGET == HWY_AVX3) { // avoids a large table that GCC would copy each time
      const auto some = hn::Gt(length, hn::Zero(di));
      hn::StoreU(hn::Compress(packed, hn::RebindMask(du, some)), du, runs + found);
      found += hn::CountTrue(di, some);
      continue;
    }
    HWY_ALIGN std::uint32_t stored[lanes];
    hn::Store(packed, du, stored);
    for (const std::uint32_t run : stored) {
      runs[found] = run;
      found += (run & run_length_mask) > 0;
    }
  }
  return found;
}

// Stride of scratch arrays, such that a full run can be written at the end of one.
HWY_INLINE std::size_t
scratchStride(std::size_t length)
{
  return strideOf(length) + longest_run;
}

// Pads the last block after the last pair.
HWY_INLINE void
fillRest(float* line, std::size_t length, float value)
{
  for (std::size_t e = length; e < strideOf(length); ++e)
    line[e] = value;
}

HWY_INLINE Floats
squared(Floats value)
{
  return hn::Mul(value, value);
}

HWY_INLINE Floats
squaredDifference(const float* values, float from)
{
  return squared(hn::Sub(hn::LoadU(d, values), hn::Set(d, from)));
}

// The box around the points of a group.
struct GroupBox {
  float low[3], high[3];

  GroupBox(const PointsView& points, const GroupView& group)
  {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float* const values = points.arrays + axis * points.stride + group.point;
      low[axis] = *std::min_element(values, values + group.points);
      high[axis] = *std::max_element(values, values + group.points);
    }
  }

  // Rounded like the distances in Nearness, and thus at most as large as these.
  HWY_INLINE Floats
  squaredDistance(const float* positions, std::size_t stride) const
  {
    auto sum = hn::Zero(d);
    for (std::size_t axis = 0; axis < 3; ++axis, positions += stride) {
      const auto position = hn::LoadU(d, positions);
      const auto beyond = hn::Max(hn::Sub(hn::Set(d, low[axis]), position),
                                  hn::Sub(position, hn::Set(d, high[axis])));
      sum = hn::Add(sum, squared(hn::Max(hn::Zero(d), beyond)));
    }
    return sum;
  }
};

std::size_t
trimRuns(const PointsView& points, const GroupView& group, std::uint32_t* trimmed)
{
  const GroupBox box(points, group);
  const auto radius = hn::Set(d, points.squared_radius);
  std::size_t count = 0;
  for (std::size_t r = 0; r < group.count; ++r) {
    const std::uint32_t first = group.runs[r] >> run_length_bits;
    const std::uint32_t length = group.runs[r] & run_length_mask;
    std::uint32_t near = 0; // a bit for each point
    for (std::uint32_t k = 0; k < length; k += lanes) {
      const auto distance =
          box.squaredDistance(points.arrays + first + k, points.stride);
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Le(distance, radius), bits);
      near |= (std::uint32_t(bits[1]) << 8 | bits[0]) << k;
    }
    near &= (std::uint32_t(1) << length) - 1;
    if (near == 0)
      continue;
    const auto begin = std::uint32_t(hwy::Num0BitsBelowLS1Bit_Nonzero32(near));
    const auto end = 32 - std::uint32_t(hwy::Num0BitsAboveMS1Bit_Nonzero32(near));
    trimmed[count++] = (first + begin) << run_length_bits | (end - begin);
  }
  return count;
}

constexpr float max_halvings = 126.0f; // largest exponent without denormal results

// 2^-v for 0 <= v <= max_halvings, to 8e-5 (Remez): enough for weights of 8 bits.
HWY_INLINE Floats
halved(Floats v)
{
  const auto magic = hn::Set(d, 12582912.0f); // 1.5 * 2^23: such sums are integers
  const auto shifted = hn::Sub(magic, v);
  const auto fraction = hn::Sub(hn::Sub(magic, shifted), v);
  auto power = hn::Mul(fraction, hn::Set(d, 0.0551716691f));
  power = hn::Mul(hn::Add(power, hn::Set(d, 0.2426111222f)), fraction);
  power = hn::Mul(hn::Add(power, hn::Set(d, 0.6932609855f)), fraction);
  power = hn::Add(power, hn::Set(d, 0.9999280735f));
  return hn::BitCast(
      d, hn::Add(hn::BitCast(du, power), hn::ShiftLeft<23>(hn::BitCast(du, shifted))));
}

// Packs two vectors of bfloat16: first in the lower halves, second in the upper ones.
HWY_INLINE Words
pack(Floats first, Floats second)
{
  const auto half = hn::Set(du, 0x8000); // rounds to nearest
  return hn::Or(
      hn::ShiftRight<16>(hn::Add(hn::BitCast(du, first), half)),
      hn::And(hn::Add(hn::BitCast(du, second), half), hn::Set(du, 0xFFFF0000u)));
}

HWY_INLINE Floats
firstOf(Words packed)
{
  return hn::BitCast(d, hn::ShiftLeft<16>(packed));
}

HWY_INLINE Floats
secondOf(Words packed)
{
  return hn::BitCast(d, hn::And(packed, hn::Set(du, 0xFFFF0000u)));
}

// Unpacks the values of pairs from words, in whole blocks.
HWY_INLINE void
unpackLine(const std::uint32_t* words, std::size_t length, float* line)
{
  for (std::size_t e = 0; e < length; e += pair_block)
    for (std::size_t k = e; k < e + half_block; k += lanes, words += lanes) {
      hwy::Prefetch(words + 192); // saves a sixth of the time
      const Words both = hn::LoadU(du, words);
      hn::StoreU(firstOf(both), d, line + k);
      hn::StoreU(secondOf(both), d, line + k + half_block);
    }
}

// 16 partial sums, each over every sixteenth pair.
struct Sums {
  Floats values[vectors];

  HWY_INLINE
  Sums()
  {
    for (Floats& value : values)
      value = hn::Zero(d);
  }

  // Adds values of the pairs from the e-th on.
  HWY_INLINE void
  add(std::size_t e, Floats more)
  {
    Floats& sum = values[e / lanes % vectors];
    sum = hn::Add(sum, more);
  }

  HWY_INLINE float
  total() const
  {
    HWY_ALIGN float parts[half_block];
    for (std::size_t v = 0; v < vectors; ++v)
      hn::Store(values[v], d, parts + v * lanes);
    const hn::FixedTag<float, 4> d4;
    auto sum = hn::Add(hn::Add(hn::Load(d4, parts), hn::Load(d4, parts + 8)),
                       hn::Add(hn::Load(d4, parts + 4), hn::Load(d4, parts + 12)));
    sum = hn::Add(sum, hn::Shuffle1032(sum));
    return hn::GetLane(hn::Add(sum, hn::Shuffle2301(sum)));
  }
};

// Gathers arrays of the neighbours of a group. Most runs are short, so they are copied
// a few floats at a time.
template <int fixed>
HWY_INLINE void
gather(const PointsView& points, const GroupView& group, std::size_t first,
       std::size_t any, float* scratch)
{
  const hn::FixedTag<float, 4> few;
  const std::size_t from_stride = points.stride, stride = scratchStride(group.length);
  const float* const arrays = points.arrays + first * from_stride;
  const std::size_t count = fixed > 0 ? std::size_t(fixed) : any;
  const auto copy = [&](const float* from, float* to) HWY_ATTR {
    for (std::size_t a = 0; a < count; ++a, from += from_stride, to += stride)
      hn::StoreU(hn::LoadU(few, from), few, to);
  };
  const std::uint32_t* const end = group.runs + group.count;
  for (const std::uint32_t* run = group.runs; run != end; ++run) {
    const float* const from = arrays + (*run >> run_length_bits);
    const std::size_t length = *run & run_length_mask;
    copy(from, scratch);
    for (std::size_t k = hn::MaxLanes(few); k < length; k += hn::MaxLanes(few))
      copy(from + k, scratch + k);
    scratch += length;
  }
}

HWY_INLINE void
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

// Whether the terms are smoothness and an appearance term with three colours, which
// have faster loops.
HWY_INLINE bool
areUsual(const PointsView& points)
{
  return points.count == 2 && points.terms[0].dimensions == 0 &&
         points.terms[1].dimensions == 3;
}

HWY_INLINE Floats
partOf(Floats squared_distance)
{
  return hn::IfThenElseZero(hn::Le(squared_distance, hn::Set(d, max_halvings)),
                            halved(squared_distance));
}

// The colours of a point, in registers.
struct Colour {
  float value[3];

  HWY_INLINE
  Colour(const PointsView& points, std::size_t point)
  {
    for (std::size_t k = 0; k < 3; ++k)
      value[k] = points.arrays[(3 + k) * points.stride + point];
  }

  // Factor of the colour differences at some pairs.
  HWY_INLINE Floats
  part(const float* gathered, std::size_t stride) const
  {
    const auto sum = hn::Add(squaredDifference(gathered, value[0]),
                             squaredDifference(gathered + stride, value[1]));
    return partOf(hn::Add(sum, squaredDifference(gathered + 2 * stride, value[2])));
  }
};

// The same for the features of any term.
HWY_INLINE Floats
featurePart(const PointsView& points, int m, std::size_t point, const float* gathered,
            std::size_t stride)
{
  const TermView& term = points.terms[m];
  auto sum = hn::Zero(d);
  for (std::size_t k = 0; k < std::size_t(term.dimensions); ++k)
    sum = hn::Add(sum, squaredDifference(
                           gathered + (term.first - 3 + k) * stride,
                           points.arrays[(term.first + k) * points.stride + point]));
  return partOf(sum);
}

// Factor of the position differences at some pairs; 0 beyond the radius.
struct Nearness {
  float x, y, z, scale, squared_radius;

  HWY_INLINE
  Nearness(const PointsView& points, std::size_t point)
      : x(points.arrays[point]), y(points.arrays[points.stride + point]),
        z(points.arrays[2 * points.stride + point]), scale(points.position_scale),
        squared_radius(points.squared_radius)
  {
    if (squared_radius > max_halvings / scale)
      squared_radius = max_halvings / scale;
  }

  HWY_INLINE Floats
  part(const float* gathered, std::size_t stride) const
  {
    auto sum = hn::Add(squaredDifference(gathered, x),
                       squaredDifference(gathered + stride, y));
    sum = hn::Add(sum, squaredDifference(gathered + 2 * stride, z));
    return hn::IfThenElseZero(hn::Le(sum, hn::Set(d, squared_radius)),
                              halved(hn::Mul(sum, hn::Set(d, scale))));
  }
};

void
sumTerms(const PointsView& points, const GroupView& group, float* scratch, float* sums,
         std::uint32_t* weights)
{
  const std::size_t stride = scratchStride(group.length), length = group.length;
  gatherArrays(points, group, 0, points.features_end, scratch);
  fillRest(scratch, length, 1e30f); // beyond every radius
  const float* const features = scratch + 3 * stride;
  float* const line = scratch + points.features_end * stride;
  const bool usual = areUsual(points);
  const std::size_t count = std::size_t(group.points);
  for (std::size_t p = 0; p < count; ++p) {
    const std::size_t point = group.point + p;
    const Nearness nearness(points, point);
    const auto eachPart = [&](auto use) HWY_ATTR {
      for (std::size_t e = 0; e < length; e += pair_block)
        for (std::size_t k = e; k < e + half_block; k += lanes, weights += lanes) {
          const auto first = nearness.part(scratch + k, stride);
          use(k, first);
          auto second = hn::Zero(d);
          if (e + half_block < length) {
            second = nearness.part(scratch + k + half_block, stride);
            use(k + half_block, second);
          }
          hn::StoreU(pack(first, second), du, weights);
        }
    };
    if (usual) {
      const Colour colour(points, point);
      Sums smoothness, appearance;
      eachPart([&](std::size_t e, Floats part) HWY_ATTR {
        smoothness.add(e, part);
        appearance.add(e, hn::Mul(part, colour.part(features + e, stride)));
      });
      sums[p] = smoothness.total();
      sums[max_points + p] = appearance.total();
      continue;
    }
    eachPart([&](std::size_t e, Floats part)
                 HWY_ATTR { hn::StoreU(part, d, line + e); });
    for (int m = 0; m < points.count; ++m) {
      Sums values;
      for (std::size_t e = 0; e < length; e += half_block)
        for (std::size_t k = e; k < e + half_block; k += lanes)
          values.add(k, hn::Mul(hn::LoadU(d, line + k),
                                featurePart(points, m, point, features + k, stride)));
      sums[std::size_t(m) * max_points + p] = values.total();
    }
  }
}

// Clears the weight of each point with itself.
HWY_INLINE void
clearOwnWeights(const GroupView& group, std::uint32_t* weights)
{
  const std::size_t end = group.point + std::size_t(group.points);
  std::size_t begin = 0; // of the run, in the pairs of a point
  for (std::size_t r = 0; r < group.count; ++r) {
    const std::size_t first = group.runs[r] >> run_length_bits;
    const std::size_t length = group.runs[r] & run_length_mask;
    if (first < end && first + length > group.point)
      for (std::size_t p = 0; p < std::size_t(group.points); ++p)
        if (group.point + p - first < length) {
          const std::size_t e = begin + group.point + p - first;
          weights[p * strideOf(group.length) / 2 + e / pair_block * half_block +
                  e % half_block] &=
              e % pair_block < half_block ? 0xFFFF0000u : 0x0000FFFFu;
        }
    begin += length;
  }
}

void
makeWeights(const PointsView& points, const GroupView& group, float* scratch,
            std::uint32_t* weights)
{
  const std::size_t stride = scratchStride(group.length), length = group.length;
  const std::size_t features = points.features_end - 3;
  const auto terms = std::size_t(points.count), count = std::size_t(group.points);
  gatherArrays(points, group, 3, features + terms, scratch);
  float* const right = scratch + features * stride;
  for (std::size_t m = 0; m < terms; ++m)
    fillRest(right + m * stride, length, 0.0f);
  const bool usual = areUsual(points);
  std::uint32_t* words = weights;
  for (std::size_t p = 0; p < count; ++p) {
    const std::size_t point = group.point + p;
    const auto scaleParts = [&](auto factorAt) HWY_ATTR {
      for (std::size_t e = 0; e < length; e += pair_block)
        for (std::size_t k = e; k < e + half_block; k += lanes, words += lanes) {
          const Words both = hn::LoadU(du, words);
          const auto first = hn::Mul(firstOf(both), factorAt(k));
          auto second = hn::Zero(d);
          if (e + half_block < length)
            second = hn::Mul(secondOf(both), factorAt(k + half_block));
          hn::StoreU(pack(first, second), du, words);
        }
    };
    if (usual) {
      const Colour colour(points, point);
      const auto smoothness = hn::Set(d, points.left[0][point]),
                 appearance = hn::Set(d, points.left[1][point]);
      scaleParts([&](std::size_t e) HWY_ATTR {
        const auto like = hn::Mul(hn::LoadU(d, right + stride + e), appearance);
        return hn::Add(hn::Mul(hn::LoadU(d, right + e), smoothness),
                       hn::Mul(like, colour.part(scratch + e, stride)));
      });
    }
    else
      scaleParts([&](std::size_t e) HWY_ATTR {
        auto sum = hn::Zero(d);
        for (std::size_t m = 0; m < terms; ++m) {
          const auto factor = hn::Mul(hn::LoadU(d, right + m * stride + e),
                                      hn::Set(d, points.left[m][point]));
          sum = hn::Add(sum, hn::Mul(factor, featurePart(points, int(m), point,
                                                         scratch + e, stride)));
        }
        return sum;
      });
  }
  clearOwnWeights(group, weights);
}

// The product for several points and vectors of rows at once: enough independent sums
// to fill the adders.
template <int points, int blocks>
HWY_INLINE void
addRows(const std::uint32_t* neighbours, const float* weights, std::size_t stride,
        std::size_t length, const float* values, std::size_t rows, float* result)
{
  constexpr int ways = points >= 3 ? 1 : points == 2 ? 2 : 4;
  Floats sums[ways][points][blocks];
  for (auto& of_way : sums)
    for (auto& of_point : of_way)
      for (Floats& sum : of_point)
        sum = hn::Zero(d);
  for (std::size_t e = 0; e < length; e += ways)
    for (int w = 0; w < ways; ++w) {
      const float* const from = values + neighbours[e + w] * rows;
      for (int b = 0; b < blocks; ++b) {
        const Floats value = hn::LoadU(d, from + b * lanes);
        for (int p = 0; p < points; ++p) {
          const auto weight = hn::Set(d, weights[std::size_t(p) * stride + e + w]);
          sums[w][p][b] = hn::Add(sums[w][p][b], hn::Mul(value, weight));
        }
      }
    }
  for (int p = 0; p < points; ++p)
    for (int b = 0; b < blocks; ++b) {
      Floats sum = sums[0][p][b];
      for (int w = 1; w < ways; ++w)
        sum = hn::Add(sum, sums[w][p][b]);
      float* const to = result + std::size_t(p) * rows + b * lanes;
      hn::StoreU(hn::Add(hn::LoadU(d, to), sum), d, to);
    }
}

// Indices of the neighbours, followed by that of a point of the group.
HWY_INLINE void
listNeighbours(const GroupView& group, std::uint32_t* neighbours)
{
  const auto lane = hn::Iota(du, 0);
  const std::uint32_t* const end = group.runs + group.count;
  for (const std::uint32_t* run = group.runs; run != end; ++run) {
    const auto numbers = hn::Add(lane, hn::Set(du, *run >> run_length_bits));
    const std::uint32_t length = *run & run_length_mask;
    for (std::uint32_t k = 0; k < longest_run; k += lanes)
      hn::StoreU(hn::Add(numbers, hn::Set(du, k)), du, neighbours + k);
    neighbours += length;
  }
  for (int k = 0; k < max_points; ++k)
    neighbours[k] = std::uint32_t(group.point);
}

void
addProduct(const GroupView& group, const std::uint32_t* packed, const float* values,
           std::size_t rows, float* scratch, float* result)
{
  const std::size_t stride = scratchStride(group.length);
  auto* const neighbours =
      reinterpret_cast<std::uint32_t*>(scratch + max_points * stride);
  listNeighbours(group, neighbours);
  for (std::size_t p = 0; p < std::size_t(group.points); ++p)
    unpackLine(packed + p * strideOf(group.length) / 2, group.length,
               scratch + p * stride);
  const std::size_t length = group.length;
  constexpr int blocks = lanes > 4 ? 16 / lanes : 2;
  for (std::size_t row = 0; row < rows; row += blocks * lanes) {
    const float* const from = values + row;
    float* const to = result + row;
    switch (group.points) {
    case 4:
      addRows<4, blocks>(neighbours, scratch, stride, length, from, rows, to);
      break;
    case 3:
      addRows<3, blocks>(neighbours, scratch, stride, length, from, rows, to);
      break;
    case 2:
      addRows<2, blocks>(neighbours, scratch, stride, length, from, rows, to);
      break;
    default:
      addRows<1, blocks>(neighbours, scratch, stride, length, from, rows, to);
    }
  }
}

constexpr TruncatedLoops loops = {findRuns, trimRuns, sumTerms, makeWeights,
                                  addProduct};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

std::size_t
scratchSize(std::size_t length, std::size_t arrays)
{
  return arrays * (strideOf(length) + longest_run);
}

const TruncatedLoops&
truncatedLoops(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

} // namespace pcl_semantic::kernels
#endif
