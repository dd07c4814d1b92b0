// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gradient_image.h"

#include <pcl_semantic/stereo/elas.h>

#include <vector>

namespace pcl_semantic {

/** \brief A pixel of the left image whose match in the right one is sure. */
struct SupportPoint {
  int u, v;
  int disparity; ///< [1 / disparity_steps px]
};

/** \brief Matches the pixels of a grid over the whole range of disparities and keeps
 * what is sure (section 3.1 of the paper), in order of rows. */
std::vector<SupportPoint> findSupportPoints(const GradientImage& left,
                                            const GradientImage& right,
                                            const Elas::Parameters& parameters);

/** \brief Adds the image's corners with the disparity of the nearest support point. */
void addCorners(int width, int height, std::vector<SupportPoint>& points);

} // namespace pcl_semantic
