// SPDX-License-Identifier: BSD-3-Clause

// Distances of descriptors, for kernels that are compiled once a target.

#if defined(PCL_SEMANTIC_STEREO_DISTANCES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef PCL_SEMANTIC_STEREO_DISTANCES_INL_H
#undef PCL_SEMANTIC_STEREO_DISTANCES_INL_H
#else
#define PCL_SEMANTIC_STEREO_DISTANCES_INL_H
#endif

#include "descriptors.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

static_assert(descriptor_bytes == 16, "a descriptor fills a block of a vector");

/** \brief One descriptor, or two one after the other: then a vector holds eight
 * distances. */
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
  // One instruction that an earlier Highway lacks: without it all takes 1.3 to 1.7
  // times as long.
  if constexpr (sizeof(V) == 32)
    return {_mm256_sad_epu8(a.raw, b.raw)};
  else
    return {_mm_sad_epu8(a.raw, b.raw)};
#else
  return hn::SumsOf8(hn::Sub(hn::Max(a, b), hn::Min(a, b)));
#endif
}

/** \brief Of each block: \a weight times the distances of \a own descriptor to the four
 * that lie \a step descriptors apart at \a others. */
template <int step, class D>
HWY_INLINE hn::Vec<hn::Repartition<std::int32_t, D>>
fourDistances(D d, hn::Vec<D> own, const std::uint8_t* others, std::int16_t weight)
{
  const hn::Repartition<std::int16_t, D> d16;
  const hn::Repartition<std::int32_t, D> d32;
  const auto halves = [&](int i) HWY_ATTR {
    return halfDistances(own, hn::LoadU(d, others + i * step * descriptor_bytes));
  };
  // Where blocks have 128 bits, this keeps the order in them.
  const auto pack = [&](auto a, auto b) HWY_ATTR {
    return hn::ReorderDemote2To(d16, hn::BitCast(d32, a), hn::BitCast(d32, b));
  };
  const auto all = pack(pack(halves(0), halves(1)), pack(halves(2), halves(3)));
  auto rest = hn::Zero(d32);
  const auto sum = hn::ReorderWidenMulAccumulate(d32, all, hn::Set(d16, weight),
                                                 hn::Zero(d32), rest);
  return hn::RearrangeToOddPlusEven(sum, rest);
}

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
