// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

// Catches Eigen alignment macros that were set by hand; export.h checks the flags.
#if defined(__x86_64__) && !defined(PCL_SEMANTIC_ALLOW_AVX)
static_assert(
    EIGEN_MAX_ALIGN_BYTES == PCL_SEMANTIC_ALIGNMENT &&
        EIGEN_DEFAULT_ALIGN_BYTES == PCL_SEMANTIC_ALIGNMENT &&
        bool(EIGEN_MALLOC_ALREADY_ALIGNED) == (PCL_SEMANTIC_ALIGNMENT == 16),
    "pcl_semantic: Eigen is set to align in another way than in PCL and pcl_semantic, "
    "whose objects would be corrupted");
#endif
