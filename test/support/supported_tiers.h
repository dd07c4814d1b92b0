/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/simd.h>

#include <vector>

namespace pcl_semantic {

/** \brief The tiers that this processor has. */
inline std::vector<SimdTier>
supportedTiers()
{
  std::vector<SimdTier> tiers = {SimdTier::plain};
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
    tiers.push_back(SimdTier::avx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    tiers.push_back(SimdTier::avx512);
  return tiers;
}

} // namespace pcl_semantic
