// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/parallel_guard.h"

#include <cstddef>

namespace pcl_semantic {

/** \brief Calls work(i, local) for 0 <= i < count on all threads; each thread makes its
 * own \a local. Rethrows an exception of a call. */
template <typename MakeLocal, typename Work>
void
forEachInParallel(std::size_t count, MakeLocal&& make_local, Work&& work)
{
  ParallelGuard guard;
#pragma omp parallel
  guard.run([&] {
    auto local = make_local();
#pragma omp for schedule(dynamic, 1) nowait
    for (std::size_t i = 0; i < count; ++i)
      guard.run([&] { work(i, local); });
  });
  guard.rethrow();
}

} // namespace pcl_semantic
