/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "smoothing.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

constexpr int block = 32; // pixels at a time

namespace plain {
#define PCL_SEMANTIC_TARGET
#include "smoothing_tier.hpp"
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace plain

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2,fma")))
#include "smoothing_tier.hpp"
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace avx2

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#include "smoothing_tier.hpp"
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace avx512

} // namespace

Smooth
smoothing(SimdTier tier)
{
  return ofTier<Smooth>(tier, plain::smoothLine, avx2::smoothLine, avx512::smoothLine);
}

} // namespace pcl_semantic::kernels
