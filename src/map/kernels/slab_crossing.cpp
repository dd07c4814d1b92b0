/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "slab_crossing.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

// What the builtin of the widest tier takes.
typedef int MaskWords __attribute__((vector_size(64)));

namespace plain {
#define PCL_SEMANTIC_TARGET
#define PCL_SEMANTIC_LANES 4
#define PCL_SEMANTIC_BITS(mask) __builtin_ia32_movmskps((Floats)(mask))
#include "bundle_crossing_tier.hpp"
#include "ray_crossing_tier.hpp"
constexpr SlabCrossing loops = {crossBundles, crossRays, crossSlabs};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
#undef PCL_SEMANTIC_BITS
} // namespace plain

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2,fma")))
#define PCL_SEMANTIC_LANES 8
#define PCL_SEMANTIC_BITS(mask) __builtin_ia32_movmskps256((Floats)(mask))
#include "bundle_crossing_tier.hpp"
#include "ray_crossing_tier.hpp"
constexpr SlabCrossing loops = {crossBundles, crossRays, crossSlabs};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
#undef PCL_SEMANTIC_BITS
} // namespace avx2

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#define PCL_SEMANTIC_LANES 16
#define PCL_SEMANTIC_BITS(mask) __builtin_ia32_cvtd2mask512((MaskWords)(mask))
#include "bundle_crossing_tier.hpp"
#include "ray_crossing_tier.hpp"
constexpr SlabCrossing loops = {crossBundles, crossRays, crossSlabs};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
#undef PCL_SEMANTIC_BITS
} // namespace avx512

} // namespace

const SlabCrossing&
slabCrossing(SimdTier tier)
{
  return ofTier(tier, plain::loops, avx2::loops, avx512::loops);
}

} // namespace pcl_semantic::kernels
