// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_sky.h"

#include "synthetic_noise.h"

#include <algorithm>

namespace pcl_semantic::synthetic {

using Eigen::Vector3d;
using Eigen::Vector3f;

Vector3f
skyColour(const Vector3d& direction, std::uint32_t seed)
{
  const double up = std::max(direction.z(), 0.0);
  const float height = static_cast<float>(std::min(1.0, 2.2 * up));
  const Vector3f clear = Vector3f(0.62f, 0.74f, 0.86f) * (1.0f - height) +
                         Vector3f(0.20f, 0.38f, 0.74f) * height;
  const Vector3d plane(direction.x() / (up + 0.12), direction.y() / (up + 0.12), 0.0);
  const double cloud =
      fractalNoise(plane, 1.6, seed) + 0.3 * valueNoise(plane * 5.0, seed + 9);
  const float cover = static_cast<float>(std::clamp(1.3 * cloud + 0.15, 0.0, 1.0));
  return clear * (1.0f - cover) + Vector3f(0.88f, 0.89f, 0.90f) * cover;
}

} // namespace pcl_semantic::synthetic
