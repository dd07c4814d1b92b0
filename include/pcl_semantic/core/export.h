// SPDX-License-Identifier: BSD-3-Clause

// Every public header includes this one, so it includes neither Eigen nor PCL.

#pragma once

#include <pcl_semantic/core/alignment.h>

// Eigen's alignment and its allocator depend on these flags. If PCL, this library and
// the program differ in them, PCL's objects are corrupted, often silently.
// Distributions compile for baseline x86-64.
#if defined(__AVX512F__)
#define PCL_SEMANTIC_ALIGNMENT_HERE 64
#elif defined(__AVX__)
#define PCL_SEMANTIC_ALIGNMENT_HERE 32
#else
#define PCL_SEMANTIC_ALIGNMENT_HERE 16
#endif
#if PCL_SEMANTIC_ALIGNMENT_HERE != PCL_SEMANTIC_ALIGNMENT &&                           \
    !defined(PCL_SEMANTIC_ALLOW_AVX)
#if PCL_SEMANTIC_ALIGNMENT == 16
#error                                                                                 \
    "pcl_semantic: do not compile with -march=native or -mavx*: Eigen then aligns and \
frees memory in another way than in PCL and pcl_semantic, and objects are corrupted"
#else
#error                                                                                 \
    "pcl_semantic: PCL and pcl_semantic were compiled with -march=native or -mavx*: \
compile with the same flags, or Eigen aligns and frees memory in another way than in \
them, and objects are corrupted"
#endif
#endif
#undef PCL_SEMANTIC_ALIGNMENT_HERE

/** \brief Exports a symbol: everything that a public header declares in `namespace
 * PCL_SEMANTIC_EXPORT pcl_semantic`. All other symbols are hidden. */
#define PCL_SEMANTIC_EXPORT [[gnu::visibility("default")]]

/** \brief Exports a template instantiation, where compilers disagree about the position
 * of a standard attribute: `extern template class PCL_SEMANTIC_INSTANCE Name<Type>`. */
#define PCL_SEMANTIC_INSTANCE __attribute__((visibility("default")))
