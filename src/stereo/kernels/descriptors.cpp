// SPDX-License-Identifier: BSD-3-Clause
#include "descriptors.h"

#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "stereo/kernels/descriptors.cpp"
#include <hwy/foreach_target.h>

#include "distances-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

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
  if (lanes <= width - 2) // again, some of them
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
  // 16 x 16 bytes change rows with columns by four perfect shuffles.
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

/** \brief Distances to the eight descriptors one after the other at \a others. */
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

constexpr Descriptors loops = {gradients, gather, addDistances};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

const Descriptors&
descriptors(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

} // namespace pcl_semantic::kernels
#endif
