/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "log_sums.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic::kernels {

namespace {

// loadBlock: some values and then anything that is finite. Loops would wait for a copy
// made piece by piece; masked loads read no further than the values.

namespace plain {
#define PCL_SEMANTIC_TARGET
inline void
loadBlock(const float* values, std::size_t count, float* block)
{
  for (std::size_t k = 0; k < log_block; ++k)
    block[k] = 1.0f;
  __builtin_memcpy(block, values, count * sizeof(float));
}

#include "log_sums_tier.hpp"
#undef PCL_SEMANTIC_TARGET
} // namespace plain

namespace avx2 {
#define PCL_SEMANTIC_TARGET __attribute__((target("avx2")))
inline PCL_SEMANTIC_TARGET __attribute__((always_inline)) void
loadBlock(const float* values, std::size_t count, float* block)
{
  typedef float Floats __attribute__((vector_size(32)));
  typedef int Ints __attribute__((vector_size(32)));
  for (int k = 0; k < int(log_block); k += 8) {
    const Ints wanted = Ints{0, 1, 2, 3, 4, 5, 6, 7} < int(count) - k;
    const Floats loaded = __builtin_ia32_maskloadps256(
        reinterpret_cast<const Floats*>(values + k), wanted);
    __builtin_memcpy(block + k, &loaded, sizeof loaded);
  }
}

#include "log_sums_tier.hpp"
#undef PCL_SEMANTIC_TARGET
} // namespace avx2

namespace avx512 {
#define PCL_SEMANTIC_TARGET                                                            \
  __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width="      \
                        "512")))
inline PCL_SEMANTIC_TARGET __attribute__((always_inline)) void
loadBlock(const float* values, std::size_t count, float* block)
{
  typedef float Floats __attribute__((vector_size(64)));
  const auto wanted = static_cast<unsigned short>((1u << count) - 1);
  const Floats loaded = __builtin_ia32_loadups512_mask(values, Floats{}, wanted);
  __builtin_memcpy(block, &loaded, sizeof loaded);
}

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
