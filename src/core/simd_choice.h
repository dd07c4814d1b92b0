// SPDX-License-Identifier: BSD-3-Clause

// How the hot loops (src/<module>/kernels/*.cpp) are compiled: Google Highway includes
// such a file once a target, and PCL_SEMANTIC_OF_TIER chooses among what came of it.
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
// What is inlined there may be no function of std, Eigen or PCL: the linker would take
// one target's copy for all callers.

#pragma once

#include "simd.h"
#include "simd_choice.h"

// GCC before 12.3 can go wrong in Highway's emulated vectors, which are then replaced
// by single values that know no shuffles. Our tests compare every kernel with a plain
// loop.
#define HWY_BROKEN_EMU128 0

#if defined(__x86_64__)
// Two tiers above the baseline are enough: more would only take longer to compile.
#define HWY_DISABLED_TARGETS ((HWY_AVX3 - 1) | HWY_SSE4 | HWY_SSSE3)
#else
#define HWY_COMPILE_ONLY_STATIC // NEON is ARM64's baseline
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

/** \brief Selects \a name (a function, or a table of them) in the namespace of a
 * tier. */
#define PCL_SEMANTIC_OF_TIER(tier, name)                                               \
  ((tier) == SimdTier::avx512 ? PCL_SEMANTIC_OF_AVX512(name)                           \
   : (tier) == SimdTier::avx2 ? PCL_SEMANTIC_OF_AVX2(name)                             \
                              : HWY_STATIC_DISPATCH(name))
