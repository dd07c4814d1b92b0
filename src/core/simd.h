// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Instruction sets that the hot loops (`src/<module>/kernels/`) are compiled
 * for. plain is what every processor of its kind has: SSE2 on x86-64, NEON on ARM64.
 * Results are bit-identical in every tier and for any number of threads. */
enum class SimdTier { plain, avx2, avx512 };

/** \brief The widest tier of this processor, or the one that the environment variable
 * PCL_SEMANTIC_SIMD (plain, neon, avx2 or avx512; neon is plain on ARM64) asks for, if
 * the processor has it; decided once, at the first call.
 * \throws InvalidParameterException if the variable holds another word */
SimdTier simdTier();

/** \brief The widest tier of this processor. */
SimdTier widestSimdTier();

/** \brief "plain", "avx2" or "avx512". */
const char* nameOf(SimdTier tier);

} // namespace pcl_semantic
