// SPDX-License-Identifier: BSD-3-Clause
#include "semi_global.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "stereo/kernels/semi_global.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

using BytesTag = hn::CappedTag<std::uint8_t, disparity_block>;
using WordsTag = hn::RepartitionToWide<BytesTag>;
using Bytes = hn::Vec<BytesTag>;
using Words = hn::Vec<WordsTag>;

constexpr BytesTag bytes;
constexpr WordsTag words;
constexpr int lanes = int(hn::MaxLanes(bytes));

HWY_INLINE Words
evenOf(Bytes values)
{
  return hn::And(hn::BitCast(words, values), hn::Set(words, 255));
}

HWY_INLINE Words
oddOf(Bytes values)
{
  return hn::ShiftRight<8>(hn::BitCast(words, values));
}

template <typename Tag>
HWY_INLINE std::uint16_t
leastWord(Tag tag, hn::Vec<Tag> values)
{
  if constexpr (hn::MaxLanes(tag) > 8) {
    const hn::Half<Tag> half;
    return leastWord(half,
                     hn::Min(hn::LowerHalf(half, values), hn::UpperHalf(half, values)));
  }
  else {
    return hn::GetLane(hn::MinOfLanes(tag, values));
  }
}

void
compareRow(const CensusRow& row, std::uint8_t* costs)
{
  for (int u = 0; u < row.width; ++u, costs += row.disparities) {
    const std::size_t first = std::size_t(row.width - 1 - u);
    for (int d = 0; d < row.disparities; d += lanes) {
      Bytes cost = hn::Zero(bytes);
      for (int b = 0; b < census_bytes; ++b) {
        const Bytes right = hn::LoadU(bytes, row.right[b] + first + std::size_t(d));
        const Bytes left = hn::Set(bytes, row.left[b][u]);
        cost = hn::Add(cost, hn::PopulationCount(hn::Xor(left, right)));
      }
      hn::StoreU(cost, bytes, costs + d);
    }
  }
}

// Divides by four and rounds.
HWY_INLINE Bytes
quarter(Bytes values)
{
  return hn::ShiftRight<2>(hn::Add(values, hn::Set(bytes, 2)));
}

void
slideRows(const std::uint8_t* added, const std::uint8_t* removed, std::size_t count,
          std::uint8_t* sums, std::uint8_t* quarters)
{
  for (std::size_t i = 0; i < count; i += lanes) {
    Bytes sum = hn::Add(hn::LoadU(bytes, sums + i), hn::LoadU(bytes, added + i));
    if (removed)
      sum = hn::Sub(sum, hn::LoadU(bytes, removed + i));
    hn::StoreU(sum, bytes, sums + i);
    hn::StoreU(quarter(sum), bytes, quarters + i);
  }
}

void
sumBlocks(const std::uint8_t* quarters, int width, int disparities, std::uint8_t* costs)
{
  for (int u = 0; u < width; ++u, costs += disparities) {
    const std::uint8_t* columns[5];
    for (int k = 0; k < 5; ++k) {
      const int at = u + k - 2;
      columns[k] = quarters + (at < 0 ? 0 : at < width ? at : width - 1) * disparities;
    }
    for (int d = 0; d < disparities; d += lanes) {
      Bytes sum = hn::LoadU(bytes, columns[0] + d);
      for (int k = 1; k < 5; ++k)
        sum = hn::Add(sum, hn::LoadU(bytes, columns[k] + d));
      hn::StoreU(quarter(sum), bytes, costs + d);
    }
  }
}

// One step of a path: replaces the path costs of the previous pixel, and their minimum,
// by those of the next one. Calls use(d, costs) for each vector.
template <typename Use>
HWY_INLINE void
step(const std::uint8_t* costs, int disparities, std::uint8_t small_step,
     std::uint8_t large_step, std::uint8_t* slot, std::uint8_t& smallest, Use&& use)
{
  const Bytes before = hn::Set(bytes, smallest);
  const Bytes small = hn::Set(bytes, small_step), large = hn::Set(bytes, large_step);
  Bytes minimum = hn::Set(bytes, 255);
  Bytes below = hn::LoadU(bytes, slot - 1);
  for (int d = 0; d < disparities; d += lanes) {
    const Bytes same = hn::LoadU(bytes, slot + d);
    const Bytes stepped =
        hn::Add(hn::Min(below, hn::LoadU(bytes, slot + d + 1)), small);
    below = hn::LoadU(bytes, slot + d + lanes - 1); // before this vector is replaced
    const Bytes best = hn::Min(hn::Sub(hn::Min(same, stepped), before), large);
    const Bytes path = hn::Add(best, hn::LoadU(bytes, costs + d));
    hn::StoreU(path, bytes, slot + d);
    minimum = hn::Min(minimum, path);
    use(d, path);
  }
  // Leaves zero in the upper bytes of the words.
  minimum = hn::Min(minimum, hn::BitCast(bytes, oddOf(minimum)));
  smallest = std::uint8_t(leastWord(words, hn::BitCast(words, minimum)));
}

// Begins a path: its costs are those of the first pixel.
HWY_INLINE std::uint8_t
beginPath(std::uint8_t* slot, int disparities)
{
  for (int d = 0; d < disparities; d += lanes)
    hn::StoreU(hn::Zero(bytes), bytes, slot + d);
  return 0;
}

void
forwardRow(const PathRow& row)
{
  const int D = row.disparities;
  const std::uint8_t* costs = row.costs;
  std::uint8_t* slot = row.down;
  std::uint8_t smallest_along = beginPath(row.along, D);
  for (int u = 0; u < row.width; ++u, costs += D, slot += D + slot_padding) {
    std::uint16_t* const even = row.sums + std::size_t(u) * std::size_t(D);
    std::uint16_t* const odd = even + D / 2;
    step(costs, D, row.small_step, row.large_step_along[u], row.along, smallest_along,
         [&](int d, Bytes path) HWY_ATTR {
           hn::StoreU(evenOf(path), words, even + d / 2);
           hn::StoreU(oddOf(path), words, odd + d / 2);
         });
    step(costs, D, row.small_step, row.large_step_down[u], slot, row.smallest_down[u],
         [&](int d, Bytes path) HWY_ATTR {
           hn::StoreU(hn::Add(hn::LoadU(words, even + d / 2), evenOf(path)), words,
                      even + d / 2);
           hn::StoreU(hn::Add(hn::LoadU(words, odd + d / 2), oddOf(path)), words,
                      odd + d / 2);
         });
  }
}

// Interleaves the masks of even and odd disparities.
HWY_INLINE hn::Mask<BytesTag>
inOrder(hn::Mask<WordsTag> even, hn::Mask<WordsTag> odd)
{
  return hn::MaskFromVec(hn::OddEven(hn::BitCast(bytes, hn::VecFromMask(words, odd)),
                                     hn::BitCast(bytes, hn::VecFromMask(words, even))));
}

// Updates the best sums and disparities of pixels of the right image.
HWY_INLINE void
chooseForRight(Words ours, Words disparity, std::uint16_t* right_sum,
               std::uint16_t* right_disparity)
{
  const Words theirs = hn::LoadU(words, right_sum);
  const Words before = hn::LoadU(words, right_disparity);
  const Words smaller = hn::Min(ours, theirs);
  hn::StoreU(smaller, words, right_sum);
  hn::StoreU(hn::IfThenElse(hn::Eq(smaller, theirs), before, disparity), words,
             right_disparity);
}

// Selects the best disparity of a pixel from its sums and their known minimum. Also
// updates the right image, where disparity d corresponds to position + d.
HWY_INLINE void
choose(const std::uint16_t* sums, int D, std::uint16_t smallest, int u, int position,
       const RowMatches& matches)
{
  std::uint16_t *right_sum[2], *right_disparity[2];
  for (int odd = 0; odd < 2; ++odd) {
    const int to = position + odd;
    right_sum[odd] = matches.right_sum[to % 2] + to / 2;
    right_disparity[odd] = matches.right_disparity[to % 2] + to / 2;
  }
  const auto limit = std::uint16_t(float(smallest) * matches.uniqueness);
  const Words least = hn::Set(words, smallest), most = hn::Set(words, limit);
  const Words count = hn::Iota(words, 0);
  int d = 0, found = 0;
  for (int i = D - lanes; i >= 0; i -= lanes) { // backwards, so that the first position
                                                // wins
    const Words even = hn::LoadU(words, sums + i / 2);
    const Words odd = hn::LoadU(words, sums + (D + i) / 2);
    const auto first =
        hn::FindFirstTrue(bytes, inOrder(hn::Eq(even, least), hn::Eq(odd, least)));
    d = first >= 0 ? i + int(first) : d;
    found += int(hn::CountTrue(bytes, inOrder(hn::Eq(hn::Min(even, most), even),
                                              hn::Eq(hn::Min(odd, most), odd))));
    const Words at = hn::Add(hn::Add(count, count), hn::Set(words, std::uint16_t(i)));
    chooseForRight(even, at, right_sum[0] + i / 2, right_disparity[0] + i / 2);
    chooseForRight(odd, hn::Add(at, hn::Set(words, 1)), right_sum[1] + i / 2,
                   right_disparity[1] + i / 2);
  }
  const auto sumAt = [&](int at) HWY_ATTR {
    return at < 0 || at >= D ? no_sum : sums[at % 2 * (D / 2) + at / 2];
  };
  std::uint16_t* const around = matches.around + 3 * u;
  for (int k = 0; k < 3; ++k)
    around[k] = sumAt(d + k - 1);
  const int own = (around[0] <= limit) + 1 + (around[2] <= limit);
  matches.has_rival[u] = found > own;
  matches.disparity[u] = std::uint8_t(d);
}

void
backwardRow(const PathRow& row, const RowMatches& matches)
{
  const int D = row.disparities;
  std::uint8_t smallest_along = beginPath(row.along, D);
  for (int u = row.width - 1; u >= 0; --u) {
    const std::size_t first = std::size_t(u) * std::size_t(D);
    std::uint16_t* const even = row.sums + first;
    std::uint16_t* const odd = even + D / 2;
    Words smallest = hn::Set(words, no_sum);
    step(row.costs + first, D, row.small_step, row.large_step_along[u + 1], row.along,
         smallest_along, [&](int d, Bytes path) HWY_ATTR {
           const Words a = hn::Add(hn::LoadU(words, even + d / 2), evenOf(path));
           const Words b = hn::Add(hn::LoadU(words, odd + d / 2), oddOf(path));
           hn::StoreU(a, words, even + d / 2);
           hn::StoreU(b, words, odd + d / 2);
           smallest = hn::Min(smallest, hn::Min(a, b));
         });
    choose(even, D, leastWord(words, smallest), u, row.width - 1 - u, matches);
  }
}

constexpr SemiGlobal loops = {compareRow, slideRows, sumBlocks, forwardRow,
                              backwardRow};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

const SemiGlobal&
semiGlobal(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

} // namespace pcl_semantic::kernels
#endif
