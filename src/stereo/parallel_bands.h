// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/parallel_guard.h"

#include <algorithm>
#include <optional>

namespace pcl_semantic {

/** \brief Processes the rows of an image in bands. Every thread makes its own worker
 * and calls use(worker, begin, end) for bands [begin, end) until none is left.
 * Exceptions pass through. */
template <typename Make, typename Use>
void
forBandsOfRows(int rows, int band_rows, const Make& make, const Use& use)
{
  ParallelGuard guard;
#pragma omp parallel
  {
    std::optional<decltype(make())> worker;
    guard.run([&] { worker.emplace(make()); });
#pragma omp for schedule(dynamic)
    for (int begin = 0; begin < rows; begin += band_rows)
      guard.run([&] {
        if (worker)
          use(*worker, begin, std::min(begin + band_rows, rows));
      });
  }
  guard.rethrow();
}

} // namespace pcl_semantic
