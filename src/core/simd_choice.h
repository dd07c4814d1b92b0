// SPDX-License-Identifier: BSD-3-Clause

// How the hot loops (src/<module>/kernels/*.cpp) are compiled: Google Highway includes
// such a file once per target, and PCL_SEMANTIC_OF_TIER selects one of the results.
//
//     //     #define HWY_TARGET_INCLUDE "module/kernels/this_file.cpp"
//     #include <hwy/foreach_target.h>
//     #include <hwy/highway.h>
//     HWY_BEFORE_NAMESPACE();
//     namespace pcl_semantic::kernels::HWY_NAMESPACE {
//     namespace {
//     void loop(...) { ... }
//     } // namespace
//     } // namespace pcl_semantic::kernels::HWY_NAMESPACE
//     HWY_AFTER_NAMESPACE();
//     #if HWY_ONCE
//     namespace pcl_semantic::kernels {
//     Loop loopOf(SimdTier tier) { return PCL_SEMANTIC_OF_TIER(tier, loop); }
//     }
//     #endif
//
// Inlined code must not call functions of std, Eigen or PCL: the linker would use one
// target's copy for all callers.

#pragma once

#include "simd.h"
#include "simd_choice.h"

// GCC before 12.3 can miscompile Highway's emulated vectors. They are replaced by
// scalars, which have no shuffles. Tests compare every kernel with a plain loop.
#define HWY_BROKEN_EMU128 0

#if defined(__x86_64__)
// Two tiers above the baseline are enough; more would only lengthen compilation.
#define HWY_DISABLED_TARGETS ((HWY_AVX3 - 1) | HWY_SSE4 | HWY_SSSE3)
#else
#define HWY_COMPILE_ONLY_STATIC // ARM64's baseline is NEON
#endif
#include <hwy/detect_targets.h>

#if HWY_TARGETS & HWY_AVX2
#define PCL_SEMANTIC_OF_AVX2(name) N_AVX2::name
#else
#define PCL_SEMANTIC_OF_AVX2(name) HWY_STATIC_DISPATCH(name)
#endif
#if HWY_TARGETS & HWY_AVX3
#define PCL_SEMANTIC_OF_AVX512(name) N_AVX3::name
#else
#define PCL_SEMANTIC_OF_AVX512(name) HWY_STATIC_DISPATCH(name)
#endif

/** \brief Selects \a name (a function or a table of functions) in the namespace of a
 * tier. */
#define PCL_SEMANTIC_OF_TIER(tier, name)                                               \
  ((tier) == SimdTier::avx512 ? PCL_SEMANTIC_OF_AVX512(name)                           \
   : (tier) == SimdTier::avx2 ? PCL_SEMANTIC_OF_AVX2(name)                             \
                              : HWY_STATIC_DISPATCH(name))
