// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Wall time of one run [s]. */
template <typename Work>
double
secondsOf(Work&& work)
{
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
      .count();
}

/** \brief Median wall time of several runs [s], after an uncounted one. */
template <typename Work>
double
medianSeconds(int runs, Work&& work)
{
  work();
  std::vector<double> seconds;
  for (int i = 0; i < runs; ++i)
    seconds.push_back(secondsOf(work));
  std::sort(seconds.begin(), seconds.end());
  return seconds[seconds.size() / 2];
}

/** \brief One figure of a benchmark; larger is better. */
inline void
printRatio(const std::string& name, double value, double target)
{
  std::printf("ratio %s %.2f target %g\n", name.c_str(), value, target);
}

} // namespace pcl_semantic
