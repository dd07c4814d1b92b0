// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_search.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/lattice_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t keys_together = 64;

// Products of 64 bits, which AVX2 does not have.
template <typename V>
HWY_INLINE V
times(V value, std::uint64_t factor)
{
  const hn::DFromV<V> d;
#if HWY_TARGET == HWY_AVX3
  return hn::Mul(value, hn::Set(d, factor));
#else
  const hn::Repartition<std::uint32_t, decltype(d)> halves;
  const auto lower = hn::BitCast(halves, value);
  const auto upper = hn::BitCast(halves, hn::ShiftRight<32>(value));
  const auto lower_factor = hn::BitCast(halves, hn::Set(d, factor));
  const auto upper_factor = hn::BitCast(halves, hn::Set(d, factor >> 32));
  const auto mixed =
      hn::Add(hn::MulEven(upper, lower_factor), hn::MulEven(lower, upper_factor));
  return hn::Add(hn::MulEven(lower, lower_factor), hn::ShiftLeft<32>(mixed));
#endif
}

void
search(const LatticeTableView& table, const std::uint64_t* keys, std::size_t count,
       std::int32_t* numbers)
{
  const LatticeTableView view = table; // numbers may not overwrite it
  const hn::ScalableTag<std::uint64_t> d;
  const hn::RebindToSigned<decltype(d)> di;
  const hn::Rebind<std::uint32_t, decltype(d)> d32;
  const hn::RebindToSigned<decltype(d32)> di32;
  const std::size_t lanes = hn::Lanes(d);
  // Only these targets have instructions that gather; indices of slots are signed.
  const bool gathers = HWY_CAP_GE256 && view.shift > 32;
  const std::size_t whole = gathers ? count - count % lanes : 0;
  // Some slots, then their keys: what one waits for does not hold up the others.
  for (std::size_t begin = 0; begin < whole; begin += keys_together) {
    const std::size_t end =
        begin + keys_together < whole ? begin + keys_together : whole;
    for (std::size_t i = begin; i < end; i += lanes) {
      auto hash = times(hn::LoadU(d, keys + i), key_factors[0]);
      hash = times(hn::Xor(hash, hn::ShiftRight<32>(hash)), key_factors[1]);
      const auto slot = hn::TruncateTo(d32, hn::ShiftRightSame(hash, view.shift));
      const auto found = hn::GatherIndex(d32, view.slots, hn::BitCast(di32, slot));
      const auto number = hn::And(found, hn::Set(d32, view.number_mask));
      hn::StoreU(hn::Sub(hn::BitCast(di32, number), hn::Set(di32, 1)), di32,
                 numbers + i);
    }
    for (std::size_t i = begin; i < end; i += lanes) {
      const auto number = hn::LoadU(di32, numbers + i);
      const auto index = hn::PromoteTo(di, hn::Max(number, hn::Zero(di32)));
      const auto known = hn::GatherIndex(d, view.keys, index);
      const auto other = hn::Xor(known, hn::LoadU(d, keys + i));
      const auto other32 =
          hn::TruncateTo(d32, hn::Or(other, hn::ShiftRight<32>(other)));
      const auto is_it = hn::Eq(hn::BitCast(di32, other32), hn::Zero(di32));
      const auto is_result = hn::Or(is_it, hn::Lt(number, hn::Zero(di32)));
      hn::StoreU(hn::IfThenElse(is_result, number, hn::Set(di32, not_first)), di32,
                 numbers + i);
    }
  }
  for (std::size_t i = whole; i < count; ++i) {
    const std::uint32_t found = view.slots[mixKey(keys[i]) >> view.shift];
    const std::uint32_t number = (found & view.number_mask) - (found != 0 ? 1 : 0);
    const bool is_it = view.keys[number] == keys[i];
    numbers[i] = found == 0 ? -1 : is_it ? std::int32_t(number) : not_first;
  }
}

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

LatticeSearch
latticeSearch(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, search);
}

} // namespace pcl_semantic::kernels
#endif
