// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "stereo/kernels/smoothing.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr hn::ScalableTag<std::int16_t> d;
constexpr int lanes = int(hn::MaxLanes(d));

HWY_INLINE void
smoothLanes(const std::int16_t* disparity, const std::int16_t* const* neighbours,
            int taps, std::int16_t range, int at, std::int16_t* smooth)
{
  const hn::Repartition<std::int32_t, decltype(d)> d32;
  const hn::Repartition<float, decltype(d)> df;
  const auto centre = hn::LoadU(d, disparity + at), zero = hn::Zero(d);
  const auto limit = hn::Set(d, range);
  auto sum = zero, number = hn::Set(d, std::int16_t(taps));
  for (int tap = 0; tap < taps; ++tap) {
    const auto other = hn::LoadU(d, neighbours[tap] + at);
    const auto difference = hn::Sub(other, centre);
    const auto unlike = hn::VecFromMask(
        d, hn::Or(hn::Lt(other, zero), hn::Gt(hn::Abs(difference), limit)));
    sum = hn::Add(sum, hn::AndNot(unlike, difference));
    number = hn::Add(number, unlike); // -1 where unlike
  }
  number = hn::Max(number, hn::Set(d, 1)); // if the pixel itself has no disparity
  // Even and odd lanes separately, because they need twice the bits.
  const auto odd = [&](auto v) HWY_ATTR {
    const auto pairs = hn::BitCast(d32, v);
    return hn::ShiftRight<16>(pairs);
  };
  const auto even = [&](auto v) HWY_ATTR {
    return odd(hn::ShiftLeft<16>(hn::BitCast(d32, v)));
  };
  const auto smoothed = [&](auto half) HWY_ATTR {
    const auto real = [&](auto v) HWY_ATTR { return hn::ConvertTo(df, half(v)); };
    const auto mean = hn::Div(real(sum), real(number));
    // Rounds a positive number to the nearest integer.
    return hn::ConvertTo(d32, hn::Add(hn::Add(real(centre), mean), hn::Set(df, 0.5f)));
  };
  const auto value = hn::OddEven(hn::BitCast(d, hn::ShiftLeft<16>(smoothed(odd))),
                                 hn::BitCast(d, smoothed(even)));
  hn::StoreU(hn::IfThenElse(hn::Lt(centre, zero), centre, value), d, smooth + at);
}

void
smoothLine(const std::int16_t* disparity, const std::int16_t* const* neighbours,
           int taps, int range, int count, std::int16_t* smooth)
{
  const auto limit = std::int16_t(range);
  if (count >= lanes) {
    for (int at = 0; at <= count - lanes; at += lanes)
      smoothLanes(disparity, neighbours, taps, limit, at, smooth);
    smoothLanes(disparity, neighbours, taps, limit, count - lanes, smooth);
    return;
  }
  // Fewer than a vector.
  std::int16_t padded[2 * max_smoothing + 2][lanes] = {}, result[lanes];
  const std::int16_t* rows[2 * max_smoothing + 1];
  const std::size_t bytes = std::size_t(count) * sizeof *smooth;
  for (int tap = 0; tap < taps; ++tap) {
    rows[tap] = padded[tap];
    __builtin_memcpy(padded[tap], neighbours[tap], bytes);
  }
  std::int16_t* const centres = padded[taps];
  __builtin_memcpy(centres, disparity, bytes);
  smoothLanes(centres, rows, taps, limit, 0, result);
  __builtin_memcpy(smooth, result, bytes);
}

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

Smooth
smoothing(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, smoothLine);
}

} // namespace pcl_semantic::kernels
#endif
