// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace pcl_semantic {

/** \brief Whether numbers that were read may be the probabilities of a point: they sum
 * to 1, as far as networks print it, or to 0 = unlabelled. Far off, they are something
 * else: logits, numbers of classes, counts. */
inline bool
isSumOfProbabilities(double sum)
{
  constexpr double tolerance = 0.1;
  return sum == 0.0 || std::abs(sum - 1.0) <= tolerance;
}

} // namespace pcl_semantic
