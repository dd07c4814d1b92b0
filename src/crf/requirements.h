// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"

#include <pcl_semantic/core/exceptions.h>

#include <Eigen/Core>

#include <cmath>
#include <cstring>

namespace pcl_semantic {

/** \brief As Eigen's allFinite(), vectorised. */
inline bool
areFinite(const float* values, Eigen::Index count)
{
  unsigned bad = 0; // combined bits, without early exit
  for (Eigen::Index i = 0; i < count; ++i) {
    unsigned bits = 0;
    std::memcpy(&bits, values + i, sizeof(bits));
    bad |= (bits & 0x7f800000u) == 0x7f800000u ? 1u : 0u;
  }
  return bad == 0;
}

/** \throws InvalidParameterException with \a message if a value is not finite */
template <int rows>
void
requireFinite(const Eigen::Matrix<float, rows, Eigen::Dynamic>& matrix,
              const char* message)
{
  if (!areFinite(matrix.data(), matrix.size()))
    badParameter(message);
}

/** \throws InvalidParameterException that names the value and its range */
inline void
requirePositive(float value, const char* name)
{
  if (!(value > 0.0f) || !std::isfinite(value))
    badParameter(name, " is ", value, ", expected more than 0");
}

/** \throws InvalidParameterException that names the value and its range */
inline void
requireWeight(float weight)
{
  if (!(weight >= 0.0f) || !std::isfinite(weight))
    badParameter("kernel weight is ", weight, ", expected 0 or more");
}

} // namespace pcl_semantic
