// SPDX-License-Identifier: BSD-3-Clause
#include "log_sums.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "map/kernels/log_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Some values and then zeros; reads no further than the values.
HWY_INLINE void
loadBlock(const float* values, std::size_t count, float* block)
{
#if HWY_CAP_GE256 // below it, masked loads read all of a vector
  const hn::CappedTag<float, log_block> d;
  for (std::size_t k = 0; k < log_block; k += hn::Lanes(d))
    hn::StoreU(hn::MaskedLoad(hn::FirstN(d, k < count ? count - k : 0), d, values + k),
               d, block + k);
#else
  for (std::size_t k = 0; k < log_block; ++k)
    block[k] = k < count ? values[k] : 0.0f;
#endif
}

void
addLogs(const float* values, std::size_t count, float smallest, std::int64_t* sums)
{
  for (std::size_t begin = 0; begin < count; begin += log_block) {
    float block[log_block];
    std::int32_t logs[log_block];
    loadBlock(values + begin, count - begin, block);
    for (std::size_t k = 0; k < log_block; ++k) { // which compilers make wide
      // A power of two and a polynomial for 2/3 to 4/3 (Chebyshev).
      const float value = block[k] > smallest ? block[k] : smallest;
      std::int32_t bits;
      __builtin_memcpy(&bits, &value, sizeof bits);
      const std::int32_t exponent = (bits - 0x3F2AAAAB) >> 23;
      bits -= exponent * (1 << 23);
      float x;
      __builtin_memcpy(&x, &bits, sizeof x);
      x -= 1.0f;
      float p = 0.13748309f * x - 0.15394272f;
      p = p * x + 0.14055812f;
      p = p * x - 0.16414520f;
      p = p * x + 0.20007233f;
      p = p * x - 0.25007930f;
      p = p * x + 0.33333272f;
      p = p * x - 0.49999934f;
      p = (p * x + 1.0f) * x;
      constexpr float scale = float(1 << log_fraction_bits);
      constexpr std::int32_t log_two = 11629080;
      logs[k] = exponent * log_two + static_cast<std::int32_t>(p * scale);
    }
    // Compilers would take the lanes apart one by one.
    const hn::CappedTag<std::int64_t, log_block> d;
    const hn::Rebind<std::int32_t, decltype(d)> narrow;
    for (std::size_t k = 0; k < log_block; k += hn::Lanes(d)) {
      std::int64_t* const sum = sums + begin + k;
      hn::StoreU(
          hn::Add(hn::LoadU(d, sum), hn::PromoteTo(d, hn::LoadU(narrow, logs + k))), d,
          sum);
    }
  }
}

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

AddLogs
addLogs(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, addLogs);
}

} // namespace pcl_semantic::kernels
#endif
