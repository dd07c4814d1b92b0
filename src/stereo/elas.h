// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/stereo/disparity_engines.h>

namespace pcl_semantic {

/** \brief Efficient large-scale stereo matching (A. Geiger, M. Roser, R. Urtasun, ACCV
 * 2010), implemented from the paper.
 *
 * Reliable matches on a coarse grid, the support points, are triangulated. Each pixel
 * then takes the disparity d of minimum energy (the paper's maximum a posteriori)
 * E(d) = beta |f(u) - f(u - d)|_1 - log(gamma + exp(-(d - mu)^2 / (2 sigma^2)))
 * among those within 3 sigma of mu, the plane of its triangle, and those of the support
 * points near it (without the exponential); f are its gradients in 5 x 5 pixels. Both
 * images are matched. Matches that fail the left-right check and small segments are
 * removed.
 *
 * Beyond the paper, disparities are refined to fractions from the distances |f - f| at
 * d - 1, d and d + 1 (two lines of equal and opposite slope through them) and smoothed,
 * and gaps are filled (disparity_cleaning.h). The result does not depend on the
 * instruction set. With fewer than three support points there are no disparities. */
class Elas : public DisparityEstimator {
public:
  /** \param[in] disparities largest disparity + 1 [px]; a multiple of 16, up to
   * kernels::largest_disparities */
  explicit Elas(int disparities) : disparities_(disparities) {}

  DisparityImage estimate(const cv::Mat& left, const cv::Mat& right) override;

private:
  int disparities_;
};

} // namespace pcl_semantic
