// SPDX-License-Identifier: BSD-3-Clause
#include "negative_logs.h"

#include <cmath>
#include <cstdint>
#include <cstring>

namespace pcl_semantic {

namespace {

// value = x 2^e with x in [sqrt(1/2), sqrt(2)), then log(1 + x) near 0
inline float
logOf(float value)
{
  std::int32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  auto e = static_cast<float>((bits >> 23) - 126);
  bits = (bits & 0x007FFFFF) | 0x3F000000;
  float x;
  std::memcpy(&x, &bits, sizeof x);
  const bool is_low = x < 0.707106781186547524f;
  e -= is_low ? 1.0f : 0.0f;
  x = (x - 1.0f) + (is_low ? x : 0.0f);
  const float x2 = x * x, x3 = x2 * x;
  float y = 7.0376836292e-2f * x - 1.1514610310e-1f;
  float y1 = -1.2420140846e-1f * x + 1.4249322787e-1f;
  float y2 = 2.0000714765e-1f * x - 2.4999993993e-1f;
  y = y * x + 1.1676998740e-1f;
  y1 = y1 * x - 1.6668057665e-1f;
  y2 = y2 * x + 3.3333331174e-1f;
  y = ((y * x3 + y1) * x3 + y2) * x3;
  x += -0.5f * x2 + y;
  return e * 0.693147180559945309f + x;
}

} // namespace

void
negateLogs(float* values, std::size_t count, float smallest)
{
  // Labels depend on exact bits, and the remaining values have those of logf.
  const std::size_t first_of_last = count / 4 * 4;
  for (std::size_t i = 0; i < first_of_last; ++i)
    values[i] = -logOf(values[i] > smallest ? values[i] : smallest);
  for (std::size_t i = first_of_last; i < count; ++i)
    values[i] = -::logf(values[i] < smallest ? smallest : values[i]);
}

} // namespace pcl_semantic
