// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fail.h"

#include <pcl_semantic/core/label_distributions.h>

#include <cstdint>
#include <limits>

namespace pcl_semantic {

/** \brief Refuses negative and non-finite numbers, such as logarithms, at the input:
 * after computations they would look like probabilities.
 * \throws BadInputException that names the first point */
inline void
requireProbabilities(const LabelDistributions& distributions)
{
  const float* const values = distributions.matrix().data();
  const auto count = std::int64_t(distributions.matrix().size());
  constexpr float largest = std::numeric_limits<float>::max();
  int bad = 0;
  for (std::int64_t i = 0; i < count; ++i)
    bad |= int(!(values[i] >= 0.0f)) | int(!(values[i] <= largest));
  for (std::int64_t i = 0; bad != 0 && i < count; ++i)
    if (!(values[i] >= 0.0f && values[i] <= largest))
      badInput("the label distribution of point ", i / distributions.classes(),
               " has a negative or non-finite probability");
}

} // namespace pcl_semantic
