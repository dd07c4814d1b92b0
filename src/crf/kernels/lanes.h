/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// How the hot loops of this room are written: bodies as inlined templates over the
// number of lanes, instantiated in one function a tier. A loop over the lanes becomes
// vector instructions if nothing unrolls it before: hence `#pragma GCC unroll 1`.

#pragma once

#include <cstddef>
#include <cstdint>

#define PCL_SEMANTIC_INLINE inline __attribute__((always_inline))
#define PCL_SEMANTIC_AVX2 __attribute__((target("avx2,fma")))
#define PCL_SEMANTIC_AVX512                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,"                          \
                        "prefer-vector-width=512")))

namespace pcl_semantic {

/** \brief How many columns ahead of their use those that an index list names are
 * fetched: members of a clique lie scattered in memory. Three times as fast as without.
 */
constexpr std::size_t kColumnsAhead = 16;

/** \brief Starts to fetch the column that comes kColumnsAhead after the e-th of
 * \a readable indices. */
PCL_SEMANTIC_INLINE void
fetchAhead(const std::int32_t* indices, std::size_t e, std::size_t readable,
           const float* columns, std::size_t stride)
{
  const std::size_t ahead = e + kColumnsAhead < readable ? e + kColumnsAhead : e;
  __builtin_prefetch(columns + std::size_t(indices[ahead]) * stride);
}

/** \brief a b + c, with one rounding where the processor can. */
template <bool UsesFma>
PCL_SEMANTIC_INLINE float
multiplyAdd(float a, float b, float c)
{
  if constexpr (UsesFma)
    return __builtin_fmaf(a, b, c);
  else
    return a * b + c;
}

} // namespace pcl_semantic
