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

#define PCL_SEMANTIC_INLINE inline __attribute__((always_inline))
#define PCL_SEMANTIC_AVX2 __attribute__((target("avx2,fma")))
#define PCL_SEMANTIC_AVX512                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,"                          \
                        "prefer-vector-width=512")))

namespace pcl_semantic {

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
