/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "lattice_filter.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

constexpr std::size_t points_ahead = 12; // to be fetched
constexpr std::size_t rows_ahead = 16;   // to be fetched

namespace plain {
#define PCL_SEMANTIC_TARGET
#define PCL_SEMANTIC_LANES 4
#include "lattice_filter_tier.hpp"
} // namespace plain

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2,fma")))
#define PCL_SEMANTIC_LANES 8
#include "lattice_filter_tier.hpp"
} // namespace avx2

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#define PCL_SEMANTIC_LANES 16
#include "lattice_filter_tier.hpp"
} // namespace avx512

} // namespace

const LatticeFilter&
latticeFilter(SimdTier tier, std::size_t width, std::size_t halves)
{
  const int number = width == 1 ? 0 : width == 4 ? 1 : width == 8 ? 2 : 3;
  return ofTier(tier, plain::filters[halves - 1][number],
                avx2::filters[halves - 1][number], avx512::filters[halves - 1][number]);
}

} // namespace pcl_semantic::kernels
