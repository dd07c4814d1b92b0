/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "ray_directions.h"

#include <pcl_semantic/core/simd_choice.h>
#include <pcl_semantic/map/directed_ray.h>
#include <pcl_semantic/map/ray_traversal.h>

namespace pcl_semantic::kernels {

namespace {

namespace plain {
#define PCL_SEMANTIC_TARGET
#include "ray_directions_tier.hpp"
#undef PCL_SEMANTIC_TARGET
} // namespace plain

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2")))
#include "ray_directions_tier.hpp"
#undef PCL_SEMANTIC_TARGET
} // namespace avx2

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#include "ray_directions_tier.hpp"
#undef PCL_SEMANTIC_TARGET
} // namespace avx512

} // namespace

FindDirections
findDirections(SimdTier tier)
{
  return ofTier(tier, plain::findDirections, avx2::findDirections,
                avx512::findDirections);
}

} // namespace pcl_semantic::kernels
