/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <Eigen/Core>

// Debian's PCL is built for baseline x86-64. A translation unit compiled with -mavx* or
// -march=native gives Eigen another alignment and another allocator, and PCL objects
// that cross the library border are then silently corrupted.
#if defined(__x86_64__)
static_assert(EIGEN_MAX_ALIGN_BYTES == 16 && EIGEN_DEFAULT_ALIGN_BYTES == 16 &&
                  EIGEN_MALLOC_ALREADY_ALIGNED,
              "pcl_semantic: do not compile with -march=native or -mavx*: it changes "
              "Eigen's alignment and corrupts the objects of Debian's PCL");
#endif
