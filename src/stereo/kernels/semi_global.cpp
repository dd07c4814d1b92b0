/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "semi_global.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

// What the builtins take.
typedef std::uint16_t EightWords __attribute__((vector_size(16)));
typedef short EightShorts __attribute__((vector_size(16)));
typedef char Chars16 __attribute__((vector_size(16)));
typedef char Chars32 __attribute__((vector_size(32)));
typedef char Chars64 __attribute__((vector_size(64)));

// Set bits of the numbers 0 to 15, in every 16 bytes.
alignas(64) constexpr std::uint8_t bit_counts[64] = {
    0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1, 1, 2, 1, 2,
    2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3,
    2, 3, 3, 4, 0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};

namespace plain {
#define PCL_SEMANTIC_TARGET
#define PCL_SEMANTIC_LANES 16
#define PCL_SEMANTIC_BITS(mask)                                                        \
  std::uint64_t(unsigned(__builtin_ia32_pmovmskb128((Chars16)(mask))))
#include "semi_global_tier.hpp"
constexpr SemiGlobal loops = {compareRow, slideRows, sumBlocks, forwardRow,
                              backwardRow};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_LAMBDA
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
#undef PCL_SEMANTIC_BITS
} // namespace plain

#define PCL_SEMANTIC_LEAST(words)                                                      \
  EightWords(__builtin_ia32_phminposuw128((EightShorts)(words)))[0]

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2,fma")))
#define PCL_SEMANTIC_LANES 32
#define PCL_SEMANTIC_BITS(mask)                                                        \
  std::uint64_t(unsigned(__builtin_ia32_pmovmskb256((Chars32)(mask))))
#define PCL_SEMANTIC_LOOK_UP(table, places)                                            \
  Bytes(__builtin_ia32_pshufb256((Chars32)(table), (Chars32)(places)))
#include "semi_global_tier.hpp"
constexpr SemiGlobal loops = {compareRow, slideRows, sumBlocks, forwardRow,
                              backwardRow};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_LAMBDA
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
#undef PCL_SEMANTIC_BITS
#undef PCL_SEMANTIC_LOOK_UP
} // namespace avx2

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
#define PCL_SEMANTIC_LANES 64
#define PCL_SEMANTIC_BITS(mask)                                                        \
  std::uint64_t(__builtin_ia32_cvtb2mask512((Chars64)(mask)))
#define PCL_SEMANTIC_LOOK_UP(table, places)                                            \
  Bytes(__builtin_ia32_pshufb512_mask((Chars64)(table), (Chars64)(places), Chars64{},  \
                                      ~0ull))
#include "semi_global_tier.hpp"
constexpr SemiGlobal loops = {compareRow, slideRows, sumBlocks, forwardRow,
                              backwardRow};
#undef PCL_SEMANTIC_INLINE
#undef PCL_SEMANTIC_LAMBDA
#undef PCL_SEMANTIC_TARGET
#undef PCL_SEMANTIC_LANES
#undef PCL_SEMANTIC_BITS
#undef PCL_SEMANTIC_LOOK_UP
} // namespace avx512

} // namespace

const SemiGlobal&
semiGlobal(SimdTier tier)
{
  return ofTier(tier, plain::loops, avx2::loops, avx512::loops);
}

} // namespace pcl_semantic::kernels
