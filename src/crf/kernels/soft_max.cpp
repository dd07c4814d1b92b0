/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "soft_max.h"

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

float
softMax(const float* costs, float* messages, float* marginals, std::size_t columns,
        std::size_t stride)
{
  float change = 0.0f;
  for (std::size_t i = 0; i < columns; ++i) {
    float* const m = messages + i * stride;
    float* const q = marginals + i * stride;
    for (std::size_t l = 0; l < stride; ++l)
      m[l] -= costs[i * stride + l];
    const float largest = *std::max_element(m, m + stride);
    float sum = 0.0f;
    for (std::size_t l = 0; l < stride; ++l)
      sum += m[l] = std::exp(m[l] - largest);
    for (std::size_t l = 0; l < stride; ++l) {
      change = std::max(change, std::abs(q[l] - m[l] / sum));
      q[l] = m[l] / sum;
      m[l] = 0.0f;
    }
  }
  return change;
}

} // namespace pcl_semantic
