// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace pcl_semantic::synthetic {

/** \brief Result of the ray of a pixel. */
struct Sample {
  Eigen::Vector3f light = Eigen::Vector3f::Zero(); ///< red, green, blue, linear
  double depth = 0.0;   ///< along the optical axis [m], 0 = none
  std::uint32_t id = 0; ///< solid, 0 = ground, 1 = none
  Label label = kUnlabelled;
  int object = 0; ///< car or pedestrian, 0 = none
};

/** \brief Casts a ray through pixel coordinates (column, row). */
using Look = std::function<Sample(double u, double v)>;

/** \brief Checks the size of images to render [px].
 * \throws InvalidParameterException unless it lies within 64 x 32 and 4096 x 4096 */
void requireImageSize(int width, int height);

/** \brief Renders an image, with more rays for the pixels on edges and with the noise
 * of a sensor; the same bytes for any number of threads.
 *
 * \param[in] noise_seed of the sensor noise
 * \param[out] samples of the pixels' centres, row by row
 * \return CV_8UC3 (BGR) */
cv::Mat renderRays(const Look& look, int width, int height, std::uint32_t noise_seed,
                   std::vector<Sample>& samples);

} // namespace pcl_semantic::synthetic
