// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace pcl_semantic {

/** \brief Whether a sum read from a file is plausible for a point's probabilities: 1
 * within the precision of network output, or 0 = unlabelled. Other sums come from
 * logits, class numbers or counts. */
inline bool
isSumOfProbabilities(double sum)
{
  constexpr double tolerance = 0.1;
  return sum == 0.0 || std::abs(sum - 1.0) <= tolerance;
}

} // namespace pcl_semantic
