// SPDX-License-Identifier: BSD-3-Clause
#include "ray_image.h"

#include "core/fail.h"
#include "noise.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace pcl_semantic::synthetic {

namespace {

using Eigen::Vector3f;

/** \brief Whether two samples differ so much that a pixel needs more rays. */
bool
differ(const Sample& a, const Sample& b)
{
  return a.id != b.id || (a.light - b.light).cwiseAbs().maxCoeff() > 0.15f;
}

/** \brief Mean of four more rays for a pixel on an edge, so that poles and window
 * frames are not jagged. */
Vector3f
smoothed(const Look& look, const std::vector<Sample>& samples, int width, int u, int v)
{
  const int index = v * width + u;
  const int height = static_cast<int>(samples.size()) / width;
  const Sample& centre = samples[index];
  const bool edge = (u > 0 && differ(centre, samples[index - 1])) ||
                    (u + 1 < width && differ(centre, samples[index + 1])) ||
                    (v > 0 && differ(centre, samples[index - width])) ||
                    (v + 1 < height && differ(centre, samples[index + width]));
  if (!edge)
    return centre.light;
  Vector3f sum = look(u - 0.375, v - 0.125).light;
  sum += look(u + 0.125, v - 0.375).light;
  sum += look(u - 0.125, v + 0.375).light;
  sum += look(u + 0.375, v + 0.125).light;
  return 0.25f * sum;
}

/** \brief Exposure, display curve and sensor noise. */
cv::Vec3b
toPixel(const Vector3f& light, std::uint32_t noise)
{
  cv::Vec3b pixel;
  for (int channel = 0; channel < 3; ++channel) {
    const float value = 255.0f * std::sqrt(std::max(light[2 - channel], 0.0f));
    const float jitter =
        static_cast<float>(noise >> (8 * channel) & 0xff) / 85.0f - 1.5f;
    pixel[channel] = cv::saturate_cast<std::uint8_t>(value + jitter);
  }
  return pixel;
}

} // namespace

void
requireImageSize(int width, int height)
{
  if (width < 64 || height < 32 || width > 4096 || height > 4096)
    fail<InvalidParameterException>("image size ", width, "x", height,
                                    ", expected 64x32 to 4096x4096");
}

cv::Mat
renderRays(const Look& look, int width, int height, std::uint32_t noise_seed,
           std::vector<Sample>& samples)
{
  samples.resize(static_cast<std::size_t>(width) * height);
  cv::Mat image(height, width, CV_8UC3);
#pragma omp parallel
  {
#pragma omp for schedule(dynamic, 4)
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u)
        samples[static_cast<std::size_t>(v) * width + u] = look(u, v);
#pragma omp for schedule(dynamic, 4)
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u)
        image.at<cv::Vec3b>(v, u) =
            toPixel(smoothed(look, samples, width, u, v), hash(u, v, noise_seed));
  }
  return image;
}

} // namespace pcl_semantic::synthetic
