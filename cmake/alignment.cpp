// SPDX-License-Identifier: BSD-3-Clause

// Never compiles: what cmake/alignment.cmake reads is in the errors.

#include <pcl/pcl_config.h>

#if defined(__AVX512F__)
#error "alignment: 64"
#elif defined(__AVX__)
#error "alignment: 32"
#else
#error "alignment: 16"
#endif

#if defined(PCL_SEMANTIC_ALLOW_AVX)
#error "allowed by hand"
#endif

// Known since PCL 1.15: that Eigen did not leave aligning to malloc, which stops at 16.
#if defined(PCL_USES_EIGEN_HANDMADE_ALIGNED_MALLOC) &&                                 \
    PCL_USES_EIGEN_HANDMADE_ALIGNED_MALLOC
#error "PCL aligns by hand"
#endif
