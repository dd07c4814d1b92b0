/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "map_disparity.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

namespace plain {
#define PCL_SEMANTIC_TARGET
#include "distances_tier.hpp"

#include "map_disparity_tier.hpp"
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace plain

#define PCL_SEMANTIC_LEAST(values) __builtin_ia32_phminposuw128(values)

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2,fma")))
#include "distances_tier.hpp"

#include "map_disparity_tier.hpp"
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace avx2

#define PCL_SEMANTIC_WIDE

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#include "distances_tier.hpp"

#include "map_disparity_tier.hpp"
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace avx512

} // namespace

MapDisparities
mapDisparities(SimdTier tier)
{
  return ofTier(tier, plain::mapDisparityRow, avx2::mapDisparityRow,
                avx512::mapDisparityRow);
}

} // namespace pcl_semantic::kernels
