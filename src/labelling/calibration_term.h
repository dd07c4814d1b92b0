// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/labelling/label_calibration.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

/** \brief The two knots around a value, and its fraction between them. */
struct CurvePosition {
  int first = -1; ///< -1: unknown, no curve
  float fraction = 0.0f;
};

/** \brief Whether there are at least two knots, and they rise. */
inline bool
areKnots(const std::vector<float>& knots)
{
  bool is_fine = knots.size() > 1;
  for (std::size_t i = 0; i < knots.size(); ++i)
    is_fine &= std::isfinite(knots[i]) && (i == 0 || knots[i] > knots[i - 1]);
  return is_fine;
}

inline CurvePosition
positionOn(const std::vector<float>& knots, float value)
{
  if (!std::isfinite(value))
    return {};
  const float inside = std::clamp(value, knots.front(), knots.back());
  const auto next = std::upper_bound(knots.begin() + 1, knots.end() - 1, inside);
  const int first = int(next - knots.begin()) - 1;
  return {first,
          (inside - knots[std::size_t(first)]) / (*next - knots[std::size_t(first)])};
}

/** \brief Log of a distribution, clamped from below. */
inline void
clampedLog(const float* distribution, int classes, float* logs)
{
  for (int l = 0; l < classes; ++l)
    logs[l] = std::log(std::max(distribution[l], kMinProbability));
}

/** \brief Whether each feature of a list of curves or knots occurs once, in order. */
template <typename Curves>
bool
areInOrder(const Curves& curves)
{
  return std::adjacent_find(curves.begin(), curves.end(),
                            [](const auto& a, const auto& b) {
                              return a.feature >= b.feature;
                            }) == curves.end();
}

} // namespace pcl_semantic
