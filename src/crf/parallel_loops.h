// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/parallel_guard.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>

namespace pcl_semantic {

/** \brief Calls work(i, local) for 0 <= i < count on all threads, each of which makes a
 * \a local of its own. Throws what one of the calls threw. */
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

/** \brief Sum of \a term(i) for 0 <= i < count, in parallel and always in the same
 * order.
 * \param[in] block terms that a thread adds up at once */
template <typename Term>
double
orderedSum(Eigen::Index count, Eigen::Index block, Term&& term)
{
  Eigen::VectorXd parts = Eigen::VectorXd::Zero((count + block - 1) / block);
#pragma omp parallel for schedule(dynamic, 1) if (count > block)
  for (Eigen::Index b = 0; b < parts.size(); ++b)
    for (Eigen::Index i = b * block; i < std::min(count, (b + 1) * block); ++i)
      parts[b] += term(i);
  double sum = 0.0;
  for (const double part : parts)
    sum += part;
  return sum;
}

} // namespace pcl_semantic
