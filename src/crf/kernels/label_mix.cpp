/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "label_mix.h"

#include "lanes.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic {

namespace {

template <bool UsesFma, std::size_t Lanes>
PCL_SEMANTIC_INLINE void
mixBody(const float* __restrict matrix, std::size_t labels, float* __restrict columns,
        std::size_t count, std::size_t stride)
{
  alignas(64) float heard[256];
  for (std::size_t i = 0; i < count; ++i) {
    float* const column = columns + i * stride;
    for (std::size_t k = 0; k < labels; ++k)
      heard[k] = -column[k];
    for (std::size_t l = 0; l < stride; l += Lanes) {
      alignas(64) float sum[Lanes] = {};
      for (std::size_t k = 0; k < labels; ++k) {
        const float* const costs = matrix + k * stride + l;
#pragma GCC unroll 1
        for (std::size_t m = 0; m < Lanes; ++m)
          sum[m] = multiplyAdd<UsesFma>(costs[m], heard[k], sum[m]);
      }
#pragma GCC unroll 1
      for (std::size_t m = 0; m < Lanes; ++m)
        column[l + m] = sum[m];
    }
  }
}

void
mixPlain(const float* matrix, std::size_t labels, float* columns, std::size_t count,
         std::size_t stride)
{
  mixBody<false, 4>(matrix, labels, columns, count, stride);
}

PCL_SEMANTIC_AVX2 void
mixAvx2(const float* matrix, std::size_t labels, float* columns, std::size_t count,
        std::size_t stride)
{
  mixBody<true, 8>(matrix, labels, columns, count, stride);
}

PCL_SEMANTIC_AVX512 void
mixAvx512(const float* matrix, std::size_t labels, float* columns, std::size_t count,
          std::size_t stride)
{
  if (stride == 8)
    mixBody<true, 8>(matrix, labels, columns, count, 8);
  else
    mixBody<true, 16>(matrix, labels, columns, count, stride);
}

} // namespace

LabelMix
labelMixFor(SimdTier tier)
{
  return ofTier(tier, mixPlain, mixAvx2, mixAvx512);
}

void
mixLabels(const float* matrix, std::size_t labels, float* columns, std::size_t count,
          std::size_t stride)
{
  static const LabelMix function = labelMixFor(simdTier());
  function(matrix, labels, columns, count, stride);
}

} // namespace pcl_semantic
