// SPDX-License-Identifier: BSD-3-Clause
#include "elas_loops.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "stereo/kernels/elas_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

static_assert(descriptor_bytes == 16, "a descriptor fills a block of a vector");

/** \brief One or two consecutive descriptors; with two, a vector holds eight distances.
 */
using Bytes = hn::CappedTag<std::uint8_t, 2 * descriptor_bytes>;
using Distances = hn::Repartition<std::int32_t, Bytes>;

/** \brief L1 distances of the halves of descriptors. */
template <typename V>
HWY_INLINE hn::Vec<hn::Repartition<std::uint64_t, hn::DFromV<V>>>
halfDistances(V a, V b)
{
#if HWY_MAJOR > 1 || HWY_MINOR >= 2
  return hn::SumsOf8AbsDiff(a, b);
#elif HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  // Highway's older versions lack this instruction; without it everything takes 1.3 to
  // 1.7 times as long.
  if constexpr (sizeof(V) == 32)
    return {_mm256_sad_epu8(a.raw, b.raw)};
  else
    return {_mm_sad_epu8(a.raw, b.raw)};
#else
  return hn::SumsOf8(hn::Sub(hn::Max(a, b), hn::Min(a, b)));
#endif
}

/** \brief For each block, \a weight times the distances of \a own descriptor to four at
 * \a others, \a step descriptors apart. */
template <int step, class D>
HWY_INLINE hn::Vec<hn::Repartition<std::int32_t, D>>
fourDistances(D d, hn::Vec<D> own, const std::uint8_t* others, std::int16_t weight)
{
  const hn::Repartition<std::int16_t, D> d16;
  const hn::Repartition<std::int32_t, D> d32;
  const auto halves = [&](int i) HWY_ATTR {
    return halfDistances(own, hn::LoadU(d, others + i * step * descriptor_bytes));
  };
  // Keeps the order within 128-bit blocks.
  const auto pack = [&](auto a, auto b) HWY_ATTR {
    return hn::ReorderDemote2To(d16, hn::BitCast(d32, a), hn::BitCast(d32, b));
  };
  const auto all = pack(pack(halves(0), halves(1)), pack(halves(2), halves(3)));
  auto rest = hn::Zero(d32);
  const auto sum = hn::ReorderWidenMulAccumulate(d32, all, hn::Set(d16, weight),
                                                 hn::Zero(d32), rest);
  return hn::RearrangeToOddPlusEven(sum, rest);
}

void
gradients(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below,
          int width, std::uint8_t* HWY_RESTRICT horizontal,
          std::uint8_t* HWY_RESTRICT vertical)
{
  const auto gradientsAt = [&](auto d16, int u) HWY_ATTR {
    const hn::Rebind<std::uint8_t, decltype(d16)> d8;
    const auto load = [&](const std::uint8_t* from) HWY_ATTR {
      return hn::PromoteTo(d16, hn::LoadU(d8, from + u));
    };
    const auto weighted = [&](auto a, auto b, auto c) HWY_ATTR {
      return hn::Add(hn::Add(a, c), hn::Add(b, b));
    };
    const auto store = [&](auto positive, auto negative, std::uint8_t* to) HWY_ATTR {
      const auto quarter = hn::ShiftRight<2>(hn::Sub(positive, negative));
      hn::StoreU(hn::DemoteTo(d8, hn::Add(quarter, hn::Set(d16, 128))), d8, to + u);
    };
    const auto upper_left = load(above - 1), upper_right = load(above + 1);
    const auto lower_left = load(below - 1), lower_right = load(below + 1);
    store(weighted(upper_right, load(row + 1), lower_right),
          weighted(upper_left, load(row - 1), lower_left), horizontal);
    store(weighted(lower_left, load(below), lower_right),
          weighted(upper_left, load(above), upper_right), vertical);
  };
  constexpr hn::ScalableTag<std::int16_t> d;
  constexpr int lanes = int(hn::MaxLanes(d));
  horizontal[0] = vertical[0] = horizontal[width - 1] = vertical[width - 1] = 128;
  for (int u = 1; u + lanes < width; u += lanes)
    gradientsAt(d, u);
  if (lanes <= width - 2) // overlaps the previous lanes
    gradientsAt(d, width - 1 - lanes);
  else
    for (int u = 1; u < width - 1; ++u)
      gradientsAt(hn::CappedTag<std::int16_t, 1>(), u);
}

void
gather(const std::uint8_t* const* elements, int count, std::uint8_t* result)
{
  constexpr hn::FixedTag<std::uint8_t, 16> d;
  using Rows = hn::Vec<decltype(d)>[16];
  // Transposes 16 x 16 bytes by four perfect shuffles.
  const auto shuffle = [&](const Rows& from, Rows& to) HWY_ATTR {
    for (int i = 0; i < 8; ++i) {
      to[2 * i] = hn::InterleaveLower(d, from[i], from[i + 8]);
      to[2 * i + 1] = hn::InterleaveUpper(d, from[i], from[i + 8]);
    }
  };
  for (int u = 0; u < count; u += 16) {
    Rows a, b;
    for (int i = 0; i < 16; ++i)
      a[i] = hn::LoadU(d, elements[i] + u);
    shuffle(a, b);
    shuffle(b, a);
    shuffle(a, b);
    shuffle(b, a);
    for (int i = 0; i < 16; ++i)
      hn::StoreU(a[i], d, result + (u + i) * descriptor_bytes);
  }
}

/** \brief Distances to the eight consecutive descriptors at \a others. */
template <class D>
HWY_INLINE hn::Vec<hn::FixedTag<std::uint16_t, 8>>
eightDistances(D d, hn::Vec<D> own, const std::uint8_t* others)
{
  const auto every_other = fourDistances<2>(d, own, others, 1);
  const auto together = [&](auto even, auto odd) HWY_ATTR {
    return hn::BitCast(hn::FixedTag<std::uint16_t, 8>(),
                       hn::Or(even, hn::ShiftLeft<16>(odd)));
  };
  if constexpr (hn::MaxLanes(d) == descriptor_bytes) {
    return together(every_other,
                    fourDistances<2>(d, own, others + descriptor_bytes, 1));
  }
  else {
    constexpr hn::FixedTag<std::int32_t, 4> half;
    return together(hn::LowerHalf(half, every_other), hn::UpperHalf(half, every_other));
  }
}

void
addDistances(const std::uint8_t* own, const std::uint8_t* others, int count,
             std::uint16_t* costs)
{
  constexpr hn::FixedTag<std::uint16_t, 8> d;
  const auto mine = hn::LoadDup128(Bytes(), own);
  for (int i = 0; i < count; i += 8)
    hn::StoreU(hn::Add(hn::LoadU(d, costs + i),
                       eightDistances(Bytes(), mine, others + i * descriptor_bytes)),
               d, costs + i);
}

constexpr Distances d32;
constexpr int lanes = int(hn::MaxLanes(d32)), vectors = 8 / lanes;

// Candidates are processed in groups of eight consecutive disparities, in the order m
// of the other image's pixels. The minimum is over keys with the candidate's energy in
// the upper bits. The lower bits break ties and identify the candidate: m for the eight
// around the plane, 8 + 8 block + m for those of support points.
constexpr std::int16_t unit = 2048; // of energy
constexpr std::int32_t none = no_energy * unit;
static_assert(8 + largest_disparities <= unit, "what is below the energy fits");

struct Eight {
  int first;                            ///< disparity
  alignas(32) std::int32_t energies[8]; ///< of the prior
};

/** \brief m in the order of fourDistances<2>(). */
alignas(32) constexpr std::int32_t indices[8] = {0, 2, 4, 6, 1, 3, 5, 7};

HWY_INLINE int
disparityOf(int direction, int first, int m)
{
  return direction < 0 ? first + 7 - m : first + m;
}

/** \brief Integer disparity of each pixel, or no_disparity. */
template <int direction>
HWY_INLINE void
findBest(const MatchRow& row, std::int16_t* disparity)
{
  hn::Vec<Distances> m[vectors], offsets[vectors]; // of the disparities
  for (int i = 0; i < vectors; ++i) {
    m[i] = hn::Load(d32, indices + i * lanes);
    offsets[i] = direction < 0 ? hn::Sub(hn::Set(d32, 7), m[i]) : m[i];
  }
  alignas(32) std::int32_t near[disparity_steps][8];
  for (int fraction = 0; fraction < disparity_steps; ++fraction)
    for (int i = 0; i < 8; ++i)
      near[fraction][i] = row.prior[fraction * 8 + indices[i]] * unit + indices[i];
  const int blocks = row.disparities / 8;
  const std::uint8_t* bytes = row.seen;
  Eight seen[largest_disparities / 8];
  for (int begin = 0; begin < row.width; begin += row.cell_size, bytes += blocks) {
    int count = 0;
    for (int block = 0; block < blocks; ++block) {
      if (bytes[block] == 0)
        continue;
      seen[count].first = 8 * block;
      for (int i = 0; i < vectors; ++i) {
        const auto is_seen = hn::TestBit(hn::Set(d32, bytes[block]),
                                         hn::Shl(hn::Set(d32, 1), offsets[i]));
        const auto prior =
            hn::IfThenElse(is_seen, hn::Set(d32, row.floor * unit), hn::Set(d32, none));
        hn::Store(hn::Add(prior, hn::Add(m[i], hn::Set(d32, 8 + 8 * block))), d32,
                  seen[count].energies + i * lanes);
      }
      ++count;
    }
    const int end =
        begin + row.cell_size < row.width ? begin + row.cell_size : row.width;
    for (int u = begin; u < end; ++u) {
      const auto mine = hn::LoadDup128(Bytes(), row.own + u * descriptor_bytes);
      const int reach = direction < 0 ? u + 1 : row.width - u;
      const int limit = reach < row.disparities ? reach : row.disparities;
      hn::Vec<Distances> least[vectors];
      for (auto& part : least)
        part = hn::Set(d32, none);
      const auto tryEight = [&](int first, const std::int32_t* energies) HWY_ATTR {
        const int at = direction < 0 ? u - first - 7 : u + first;
        for (int i = 0; i < vectors; ++i) {
          auto sums =
              hn::Add(hn::Load(d32, energies + i * lanes),
                      fourDistances<2>(Bytes(), mine,
                                       row.other + (at + i) * descriptor_bytes, unit));
          if (first < 0 || first + 8 > limit) {
            const auto d = hn::Add(offsets[i], hn::Set(d32, first));
            const auto beyond =
                hn::Or(hn::Lt(d, hn::Zero(d32)), hn::Gt(d, hn::Set(d32, limit - 1)));
            sums = hn::IfThenElse(beyond, hn::Set(d32, none), sums);
          }
          least[i] = hn::Min(least[i], sums);
        }
      };
      const int expected = row.plane[u];
      const int near_first = expected / disparity_steps - 3;
      if (expected >= 0 && near_first < limit)
        tryEight(near_first, near[expected % disparity_steps]);
      for (int i = 0; i < count && seen[i].first < limit; ++i)
        tryEight(seen[i].first, seen[i].energies);
      for (int i = 1; i < vectors; ++i)
        least[0] = hn::Min(least[0], least[i]);
      const std::int32_t best = hn::GetLane(hn::MinOfLanes(d32, least[0]));
      const int key = best & (unit - 1), around_plane = key < 8;
      const int first = key / 8 * 8 - 8 + around_plane * (near_first + 8);
      disparity[u] = best < none ? std::int16_t(disparityOf(direction, first, key % 8))
                                 : no_disparity;
    }
  }
}

/** \brief Disparity with its fraction, from the distances at d - 1, d and d + 1: two
 * lines of equal and opposite slope, the model for L1 distances. */
HWY_INLINE std::int16_t
refine(const MatchRow& row, int u, int d)
{
  constexpr hn::FixedTag<std::uint8_t, descriptor_bytes> d8;
  const auto mine = hn::LoadU(d8, row.own + u * descriptor_bytes);
  const std::uint8_t* const before =
      row.other + (u + row.direction * d - 1) * descriptor_bytes;
  alignas(16) std::int32_t e[4]; // the last one is unused
  hn::Store(fourDistances<1>(d8, mine, before, 1), hn::FixedTag<std::int32_t, 4>(), e);
  const int rise = (e[0] > e[2] ? e[0] : e[2]) - e[1];
  int fraction = 0;
  if (rise > 0) {
    const int twice = // twice the fraction, times the rise
        disparity_steps * row.direction * (e[0] - e[2]);
    fraction = (twice + (twice < 0 ? -rise : rise)) / (2 * rise);
    const int half = disparity_steps / 2;
    fraction = fraction < -half ? -half : fraction > half ? half : fraction;
  }
  const int disparity = d * disparity_steps + fraction;
  return std::int16_t(disparity < 0 ? 0 : disparity);
}

void
matchRow(const MatchRow& row, std::int16_t* disparity)
{
  if (row.direction < 0)
    findBest<-1>(row, disparity);
  else
    findBest<1>(row, disparity);
  // A separate loop, which overlaps more pixels.
  for (int u = 0; u < row.width; ++u)
    if (disparity[u] >= 0)
      disparity[u] = refine(row, u, disparity[u]);
}

constexpr ElasLoops loops = {gradients, gather, addDistances, matchRow};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

const ElasLoops&
elasLoops(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

} // namespace pcl_semantic::kernels
#endif
