// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Instruction sets for which the hot loops (`src/<module>/kernels/`) are
 * compiled. plain is the baseline: SSE2 on x86-64, NEON on ARM64. Results are
 * bit-identical in every tier and for any number of threads. */
enum class SimdTier { plain, avx2, avx512 };

/** \brief The widest tier of this processor, or the one requested by the environment
 * variable PCL_SEMANTIC_SIMD (plain, neon, avx2 or avx512; neon is plain on ARM64) if
 * the processor supports it. Decided at the first call.
 * \throws InvalidParameterException if the variable has another value */
SimdTier simdTier();

SimdTier widestSimdTier();

/** \brief "plain", "avx2" or "avx512". */
const char* nameOf(SimdTier tier);

} // namespace pcl_semantic
