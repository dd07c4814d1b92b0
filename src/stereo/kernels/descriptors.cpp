/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "descriptors.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

namespace plain {
#define PCL_SEMANTIC_TARGET
#include "distances_tier.hpp"

#include "descriptors_tier.hpp"
constexpr Descriptors loops = {gradients, gather, addDistances};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace plain

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2,fma")))
#include "distances_tier.hpp"

#include "descriptors_tier.hpp"
constexpr Descriptors loops = {gradients, gather, addDistances};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace avx2

#define PCL_SEMANTIC_WIDE

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#include "distances_tier.hpp"

#include "descriptors_tier.hpp"
constexpr Descriptors loops = {gradients, gather, addDistances};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
} // namespace avx512

} // namespace

const Descriptors&
descriptors(SimdTier tier)
{
  return ofTier(tier, plain::loops, avx2::loops, avx512::loops);
}

} // namespace pcl_semantic::kernels
