/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "log_sums.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

namespace plain {
#define PCL_SEMANTIC_TARGET
#include "log_sums_tier.hpp"
#undef PCL_SEMANTIC_TARGET
} // namespace plain

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2")))
#include "log_sums_tier.hpp"
#undef PCL_SEMANTIC_TARGET
} // namespace avx2

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#include "log_sums_tier.hpp"
#undef PCL_SEMANTIC_TARGET
} // namespace avx512

} // namespace

AddLogs
addLogs(SimdTier tier)
{
  return ofTier(tier, plain::addLogs, avx2::addLogs, avx512::addLogs);
}

} // namespace pcl_semantic::kernels
