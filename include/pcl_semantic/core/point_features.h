// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Features that separate classes independently of a network. */
enum class Feature {
  height,     ///< above the ground [m]
  distance,   ///< along the optical axis [m]
  level,      ///< |cosine| between surface normal and ground normal; 1 = floor, 0 =
              ///< wall
  side,       ///< lateral distance from the camera, along the ground [m]
  brightness, ///< mean of red, green and blue, 0 to 1
  red,        ///< red / (red + green + blue)
  green,      ///< green / (red + green + blue)
};

/// Names of the features, in the order of the enumeration.
constexpr std::array feature_names{"height",     "distance", "level", "side",
                                   "brightness", "red",      "green"};

constexpr std::size_t feature_count = feature_names.size();

inline const char*
nameOf(Feature feature)
{
  return feature_names[std::size_t(feature)];
}

inline std::optional<Feature>
findFeature(const std::string& name)
{
  for (std::size_t f = 0; f < feature_count; ++f)
    if (name == feature_names[f])
      return Feature(f);
  return {};
}

/** \brief The features of a pixel; NaN = unknown. */
class PointFeatures {
public:
  PointFeatures() { values_.fill(std::numeric_limits<float>::quiet_NaN()); }

  float&
  operator[](Feature feature)
  {
    return values_[std::size_t(feature)];
  }

  float
  operator[](Feature feature) const
  {
    return values_[std::size_t(feature)];
  }

  /** \brief Sets brightness, red and green from a colour, 0 to 255 each. Black has only
   * a brightness. */
  void
  setColour(float red, float green, float blue)
  {
    const float sum = red + green + blue;
    (*this)[Feature::brightness] = sum / 765.0f;
    if (!(sum > 0.0f))
      return;
    (*this)[Feature::red] = red / sum;
    (*this)[Feature::green] = green / sum;
  }

private:
  std::array<float, feature_count> values_;
};

} // namespace pcl_semantic
