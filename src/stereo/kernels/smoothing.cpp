/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "smoothing.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

constexpr int block = 64; // pixels at a time: their sums stay in the first cache

#define PCL_SEMANTIC_INLINE inline __attribute__((always_inline))

PCL_SEMANTIC_INLINE void
smoothBlock(const std::int16_t* disparity, const std::int16_t* const* neighbours,
            int places, std::int16_t limit, std::size_t at, std::size_t length,
            std::int16_t* smooth)
{
  std::int16_t centre[block] = {}, sum[block] = {}, number[block] = {};
  std::int16_t other[block] = {};
  __builtin_memcpy(centre, disparity + at, length * sizeof *centre);
  for (int place = 0; place < places; ++place) {
    __builtin_memcpy(other, neighbours[place] + at, length * sizeof *other);
    for (int i = 0; i < block; ++i) {
      const std::int16_t difference = std::int16_t(other[i] - centre[i]);
      const bool counts =
          (other[i] >= 0) & (difference <= limit) & (difference >= -limit);
      sum[i] = std::int16_t(sum[i] + (counts ? difference : 0));
      number[i] = std::int16_t(number[i] + (counts ? 1 : 0));
    }
  }
  for (int i = 0; i < block; ++i) {
    const float mean = float(sum[i]) / float(number[i] > 0 ? number[i] : 1);
    const int value = int(float(centre[i]) + mean + 0.5f); // of a positive number
    sum[i] = std::int16_t(centre[i] < 0 ? centre[i] : value);
  }
  __builtin_memcpy(smooth + at, sum, length * sizeof *sum);
}

PCL_SEMANTIC_INLINE void
smoothBody(const std::int16_t* disparity, const std::int16_t* const* neighbours,
           int places, int range, int count, std::int16_t* smooth)
{
  const std::size_t end = std::size_t(count), whole = end / block * block;
  for (std::size_t at = 0; at < whole; at += block)
    smoothBlock(disparity, neighbours, places, std::int16_t(range), at, block, smooth);
  if (whole < end)
    smoothBlock(disparity, neighbours, places, std::int16_t(range), whole, end - whole,
                smooth);
}

void
smoothPlain(const std::int16_t* disparity, const std::int16_t* const* neighbours,
            int places, int range, int count, std::int16_t* smooth)
{
  smoothBody(disparity, neighbours, places, range, count, smooth);
}

__attribute__((target("avx2,fma"))) void
smoothAvx2(const std::int16_t* disparity, const std::int16_t* const* neighbours,
           int places, int range, int count, std::int16_t* smooth)
{
  smoothBody(disparity, neighbours, places, range, count, smooth);
}

__attribute__((
    target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512"))) void
smoothAvx512(const std::int16_t* disparity, const std::int16_t* const* neighbours,
             int places, int range, int count, std::int16_t* smooth)
{
  smoothBody(disparity, neighbours, places, range, count, smooth);
}

} // namespace

Smooth
smoothing(SimdTier tier)
{
  return ofTier<Smooth>(tier, smoothPlain, smoothAvx2, smoothAvx512);
}

} // namespace pcl_semantic::kernels
