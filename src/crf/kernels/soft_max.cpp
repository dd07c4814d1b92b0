/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "soft_max.h"

#include "lanes.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic {

namespace {

// exp(-a) for a >= 0, 0 from a = 55: 2^n e^r with n = round(-a / ln 2) and |r| <= ln 2
// /
// 2. (e^r - 1 - r) / r^2 is the polynomial of degree 4 with the least largest error of
// the whole (3e-9; Remez). Masks instead of conditions: compilers make branches of
// those.
template <bool UsesFma>
PCL_SEMANTIC_INLINE float
exponentialOfMinus(float a)
{
  constexpr float rounder = 12582912.0f; // 1.5 * 2^23: the unit of its last bit is 1
  const float rounded = multiplyAdd<UsesFma>(a, -1.44269504f, rounder);
  const float n = rounded - rounder;
  float r = multiplyAdd<UsesFma>(n, -0.693359375f, -a); // ln 2 in two parts
  r = multiplyAdd<UsesFma>(n, 2.12194440e-4f, r);
  float sum = 1.38146133e-3f;
  sum = multiplyAdd<UsesFma>(sum, r, 8.36870982e-3f);
  sum = multiplyAdd<UsesFma>(sum, r, 4.16683874e-2f);
  sum = multiplyAdd<UsesFma>(sum, r, 1.66665207e-1f);
  sum = multiplyAdd<UsesFma>(sum, r, 4.99999935e-1f);
  sum = multiplyAdd<UsesFma>(sum, r * r, r) + 1.0f;
  const unsigned power = (__builtin_bit_cast(unsigned, rounded) + 127u) << 23;
  const float value = sum * __builtin_bit_cast(float, power);
  const int keep = (__builtin_bit_cast(int, a) - __builtin_bit_cast(int, 55.0f)) >> 31;
  return __builtin_bit_cast(float, __builtin_bit_cast(int, value) & keep);
}

PCL_SEMANTIC_INLINE float
largerOf(float a, float b)
{
  return a > b ? a : b;
}

template <std::size_t Half>
PCL_SEMANTIC_INLINE float
largestOf(float* values)
{
#pragma GCC unroll 1
  for (std::size_t k = 0; k < Half; ++k)
    values[k] = largerOf(values[k + Half], values[k]);
  if constexpr (Half > 1)
    return largestOf<Half / 2>(values);
  return values[0];
}

template <std::size_t Half>
PCL_SEMANTIC_INLINE float
sumOf(float* values)
{
#pragma GCC unroll 1
  for (std::size_t k = 0; k < Half; ++k)
    values[k] += values[k + Half];
  if constexpr (Half > 1)
    return sumOf<Half / 2>(values);
  return values[0];
}

// A column goes through the cache three times: largest exponent, exponentials and their
// sum, probabilities.
template <bool UsesFma, std::size_t Lanes>
PCL_SEMANTIC_INLINE float
softMaxBody(const float* __restrict costs, float* __restrict messages,
            float* __restrict marginals, std::size_t columns, std::size_t stride)
{
  alignas(64) float change[Lanes] = {};
  for (std::size_t i = 0; i < columns; ++i) {
    const float* const cost = costs + i * stride;
    float* const message = messages + i * stride;
    float* const marginal = marginals + i * stride;
    alignas(64) float largest[Lanes];
#pragma GCC unroll 1
    for (std::size_t k = 0; k < Lanes; ++k)
      largest[k] = message[k] - cost[k];
    for (std::size_t l = Lanes; l < stride; l += Lanes)
#pragma GCC unroll 1
      for (std::size_t k = 0; k < Lanes; ++k)
        largest[k] = largerOf(message[l + k] - cost[l + k], largest[k]);
    const float top = largestOf<Lanes / 2>(largest);
    alignas(64) float sum[Lanes] = {};
    for (std::size_t l = 0; l < stride; l += Lanes)
#pragma GCC unroll 1
      for (std::size_t k = 0; k < Lanes; ++k) {
        message[l + k] =
            exponentialOfMinus<UsesFma>(top - (message[l + k] - cost[l + k]));
        sum[k] += message[l + k];
      }
    const float scale = 1.0f / sumOf<Lanes / 2>(sum);
    for (std::size_t l = 0; l < stride; l += Lanes)
#pragma GCC unroll 1
      for (std::size_t k = 0; k < Lanes; ++k) {
        const float probability = message[l + k] * scale;
        change[k] = largerOf(__builtin_fabsf(probability - marginal[l + k]), change[k]);
        marginal[l + k] = probability;
        message[l + k] = 0.0f;
      }
  }
  return largestOf<Lanes / 2>(change);
}

float
softMaxPlain(const float* costs, float* messages, float* marginals, std::size_t columns,
             std::size_t stride)
{
  return softMaxBody<false, 4>(costs, messages, marginals, columns, stride);
}

PCL_SEMANTIC_AVX2 float
softMaxAvx2(const float* costs, float* messages, float* marginals, std::size_t columns,
            std::size_t stride)
{
  return softMaxBody<true, 8>(costs, messages, marginals, columns, stride);
}

PCL_SEMANTIC_AVX512 float
softMaxAvx512(const float* costs, float* messages, float* marginals,
              std::size_t columns, std::size_t stride)
{
  if (stride == 8)
    return softMaxBody<true, 8>(costs, messages, marginals, columns, 8);
  if (stride == 16)
    return softMaxBody<true, 16>(costs, messages, marginals, columns, 16);
  return softMaxBody<true, 16>(costs, messages, marginals, columns, stride);
}

} // namespace

SoftMax
softMaxFor(SimdTier tier)
{
  return ofTier(tier, softMaxPlain, softMaxAvx2, softMaxAvx512);
}

float
softMax(const float* costs, float* messages, float* marginals, std::size_t columns,
        std::size_t stride)
{
  static const SoftMax function = softMaxFor(simdTier());
  return function(costs, messages, marginals, columns, stride);
}

} // namespace pcl_semantic
