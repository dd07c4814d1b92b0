// SPDX-License-Identifier: BSD-3-Clause
#include "simd.h"
#include "fail.h"

#include <hwy/targets.h>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace pcl_semantic {

namespace {

SimdTier
chosenTier()
{
  const char* const word = std::getenv("PCL_SEMANTIC_SIMD");
  if (!word || !*word)
    return widestSimdTier();
  if (std::string(word) == "neon")
    return SimdTier::plain;
  for (const SimdTier tier : {SimdTier::plain, SimdTier::avx2, SimdTier::avx512})
    if (std::string(word) == nameOf(tier))
      return std::min(tier, widestSimdTier());
  badParameter("PCL_SEMANTIC_SIMD is '", word,
               "', expected plain, neon, avx2 or avx512");
}

} // namespace

SimdTier
widestSimdTier()
{
#if defined(__x86_64__)
  const auto supported = hwy::SupportedTargets();
  if (supported & HWY_AVX3)
    return SimdTier::avx512;
  if (supported & HWY_AVX2)
    return SimdTier::avx2;
#endif
  return SimdTier::plain;
}

SimdTier
simdTier()
{
  static const SimdTier tier = chosenTier();
  return tier;
}

const char*
nameOf(SimdTier tier)
{
  switch (tier) {
  case SimdTier::avx512:
    return "avx512";
  case SimdTier::avx2:
    return "avx2";
  default:
    return "plain";
  }
}

} // namespace pcl_semantic
