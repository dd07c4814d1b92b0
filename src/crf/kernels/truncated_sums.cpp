/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "truncated_sums.h"

#include "run_search.h"

#include <pcl_semantic/core/simd_choice.h>

#include <algorithm>

namespace pcl_semantic::kernels {

namespace {

// Floats between two arrays of scratch: a run may be written whole at the end of one.
constexpr std::size_t
scratchStride(std::size_t length)
{
  return strideOf(length) + longest_run;
}

namespace plain {
#define PCL_SEMANTIC_TARGET
#define PCL_SEMANTIC_LANES 4
#include "float_lanes_tier.hpp"
#include "truncated_product_tier.hpp"
#include "truncated_sums_tier.hpp"
constexpr TruncatedSums loops = {sumTerms, makeWeights, addProduct};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
} // namespace plain

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2,fma")))
#define PCL_SEMANTIC_LANES 8
#include "float_lanes_tier.hpp"
#include "truncated_product_tier.hpp"
#include "truncated_sums_tier.hpp"
constexpr TruncatedSums loops = {sumTerms, makeWeights, addProduct};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
} // namespace avx2

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#define PCL_SEMANTIC_LANES 16
#include "float_lanes_tier.hpp"
#include "truncated_product_tier.hpp"
#include "truncated_sums_tier.hpp"
constexpr TruncatedSums loops = {sumTerms, makeWeights, addProduct};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
} // namespace avx512

} // namespace

std::size_t
scratchSize(std::size_t length, std::size_t arrays)
{
  return arrays * scratchStride(length);
}

const TruncatedSums&
truncatedSums(SimdTier tier)
{
  return ofTier(tier, plain::loops, avx2::loops, avx512::loops);
}

} // namespace pcl_semantic::kernels
