// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/simd.h"

#include <vector>

namespace pcl_semantic {

inline std::vector<SimdTier>
supportedTiers()
{
  std::vector<SimdTier> tiers = {SimdTier::plain};
  for (const SimdTier tier : {SimdTier::avx2, SimdTier::avx512})
    if (tier <= widestSimdTier())
      tiers.push_back(tier);
  return tiers;
}

} // namespace pcl_semantic
