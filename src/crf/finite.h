// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstring>

namespace pcl_semantic {

/** \brief As Eigen's allFinite(), many values at once. */
inline bool
areFinite(const float* values, Eigen::Index count)
{
  unsigned bad = 0; // bits put together instead of an early exit
  for (Eigen::Index i = 0; i < count; ++i) {
    unsigned bits = 0;
    std::memcpy(&bits, values + i, sizeof(bits));
    bad |= (bits & 0x7f800000u) == 0x7f800000u ? 1u : 0u;
  }
  return bad == 0;
}

template <int rows>
bool
areFinite(const Eigen::Matrix<float, rows, Eigen::Dynamic>& matrix)
{
  return areFinite(matrix.data(), matrix.size());
}

} // namespace pcl_semantic
