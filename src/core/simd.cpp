/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/simd.h>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace pcl_semantic {

namespace {

SimdTier
widestTier()
{
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
    return SimdTier::plain;
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512bw") ||
      !__builtin_cpu_supports("avx512vl") || !__builtin_cpu_supports("avx512dq"))
    return SimdTier::avx2;
  return SimdTier::avx512;
}

SimdTier
chosenTier()
{
  const char* const word = std::getenv("PCL_SEMANTIC_SIMD");
  if (!word || !*word)
    return widestTier();
  for (const SimdTier tier : {SimdTier::plain, SimdTier::avx2, SimdTier::avx512})
    if (std::string(word) == nameOf(tier))
      return std::min(tier, widestTier());
  PCL_THROW_EXCEPTION(InvalidParameterException,
                      "PCL_SEMANTIC_SIMD is '" << word
                                               << "', expected plain, avx2 or avx512");
}

} // namespace

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
