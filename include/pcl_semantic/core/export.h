/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Every public header includes this one and nothing heavy comes with it: the inner
// loops see neither Eigen nor PCL.

#pragma once

// Debian's PCL is built for baseline x86-64. Compiled with these flags Eigen aligns and
// frees memory in another way, and PCL's objects are corrupted, often silently. It can
// only go well where PCL, this library and the program all have the same flags.
#if defined(__AVX__) && !defined(PCL_SEMANTIC_ALLOW_AVX)
#error                                                                                 \
    "pcl_semantic: do not compile with -march=native or -mavx*: Eigen then aligns and \
frees memory in another way than Debian's PCL, and its objects are corrupted. If PCL \
and pcl_semantic were compiled with the same flags, define PCL_SEMANTIC_ALLOW_AVX"
#endif

/** \brief What the library shows of itself: everything that a public header declares in
 * `namespace PCL_SEMANTIC_EXPORT pcl_semantic`. All else is hidden. */
#define PCL_SEMANTIC_EXPORT [[gnu::visibility("default")]]
