// SPDX-License-Identifier: BSD-3-Clause
#include "map_disparity.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "stereo/kernels/map_disparity.cpp"
#include <hwy/foreach_target.h>

#include "distances-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

constexpr Distances d32;
constexpr int lanes = int(hn::MaxLanes(d32)), vectors = 8 / lanes;

// Candidates are eights of one disparity after the other, in the order m of the other
// image's pixels. The least is looked for of what has a candidate's energy in its upper
// bits and below it what decides among equals and tells whose it is: m of the eight
// around the plane, 8 + 8 block + m of those seen near.
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

/** \brief Whole disparity of each pixel, or no_disparity. */
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

/** \brief Disparity with its fraction, from the distances there and at its neighbours:
 * two lines of equal and opposite slope, which distances (L1) follow. */
HWY_INLINE std::int16_t
refine(const MatchRow& row, int u, int d)
{
  constexpr hn::FixedTag<std::uint8_t, descriptor_bytes> d8;
  const auto mine = hn::LoadU(d8, row.own + u * descriptor_bytes);
  const std::uint8_t* const before =
      row.other + (u + row.direction * d - 1) * descriptor_bytes;
  alignas(16) std::int32_t e[4]; // the last one is of no use
  hn::Store(fourDistances<1>(d8, mine, before, 1), hn::FixedTag<std::int32_t, 4>(), e);
  const int rise = (e[0] > e[2] ? e[0] : e[2]) - e[1];
  int fraction = 0;
  if (rise > 0) {
    const int twice = // over 2 rise: the fraction
        disparity_steps * row.direction * (e[0] - e[2]);
    fraction = (twice + (twice < 0 ? -rise : rise)) / (2 * rise);
    const int half = disparity_steps / 2;
    fraction = fraction < -half ? -half : fraction > half ? half : fraction;
  }
  const int disparity = d * disparity_steps + fraction;
  return std::int16_t(disparity < 0 ? 0 : disparity);
}

void
mapDisparityRow(const MatchRow& row, std::int16_t* disparity)
{
  if (row.direction < 0)
    findBest<-1>(row, disparity);
  else
    findBest<1>(row, disparity);
  // By themselves, as then more pixels are under way at a time.
  for (int u = 0; u < row.width; ++u)
    if (disparity[u] >= 0)
      disparity[u] = refine(row, u, disparity[u]);
}

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

MapDisparities
mapDisparities(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, mapDisparityRow);
}

} // namespace pcl_semantic::kernels
#endif
