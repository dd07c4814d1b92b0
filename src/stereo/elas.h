// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/stereo/disparity_estimator.h>

namespace pcl_semantic {

/** \brief Efficient large-scale stereo matching (A. Geiger, M. Roser, R. Urtasun, ACCV
 * 2010), written from the paper.
 *
 * Sure matches on a coarse grid, the support points, are triangulated. Each pixel then
 * takes the disparity d of the least energy (the paper's maximum a posteriori)
 *   E(d) = beta |f(u) - f(u - d)|_1 - log(gamma + exp(-(d - mu)^2 / (2 sigma^2)))
 * among those within 3 sigma of mu, the plane of its triangle, and those of the support
 * points near it (without the exponential); f are its gradients in 5 x 5 pixels. This
 * is done for both images, and matches that do not agree are dropped, as are small
 * segments.
 *
 * Beyond the paper: disparities are refined to fractions from the distances |f - f| at
 * d - 1, d and d + 1 (two lines of equal and opposite slope through them); they are
 * smoothed (smoothing_range); gaps are filled along rows: on a line between two ends
 * closer than gap_step, else with the farther one, for what is hidden lies behind; at
 * the border with the only end. The standard deviation is one of three values: matched,
 * filled between like ends, filled otherwise.
 *
 * Colour images are matched as grey ones. The result does not depend on the number of
 * threads nor on the instruction set. Without three support points nothing is found. */
class Elas : public DisparityEstimator {
public:
  /** \brief beta, gamma, sigma and tau as the paper names them; their values, as all
   * others, are those that were best for our gradients on KITTI. */
  struct Parameters {
    int disparities = 128;          ///< largest disparity + 1 [px]; a multiple of 16
    int support_step = 5;           ///< one pixel in so many is matched first [px]
    int support_texture = 1;        ///< least mean gradient of a support point [0-127]
    double tau = 0.9;               ///< its best distance is below this of the second
    double support_tolerance = 1.0; ///< between its two images [px]
    int support_neighbours = 2;     ///< so many within 25 px have to be like it
    double beta = 0.06;             ///< weight of a grey level of gradient
    double gamma = 0.5;             ///< fraction of what is far from the plane
    double sigma = 1.0;             ///< of the prior around the plane [px]
    double left_right_tolerance = 0.6; ///< between the images' disparities [px]
    int speckle_size = 200;       ///< smaller segments are dropped [px]; 0 keeps all
    double speckle_range = 1.0;   ///< disparity step within a segment [px]
    int smoothing_radius = 5;     ///< along row and column [px]; 0 = none
    double smoothing_range = 4.0; ///< what differs by more does not count [px]
    int gap_width = 10000;        ///< longer gaps in a row stay [px]; 0 fills none
    double gap_step = 6.0;        ///< of the two ends of a gap, see above [px]

    /** \throws InvalidParameterException that names the parameter and its range */
    void validate() const;
  };

  Elas() : Elas(Parameters()) {}

  /** \throws InvalidParameterException as Parameters::validate() */
  explicit Elas(const Parameters& parameters);

  const Parameters&
  parameters() const
  {
    return parameters_;
  }

  /** \throws BadInputException if the images do not fit each other, or are larger than
   * 16384 pixels across */
  DisparityImage estimate(const cv::Mat& left, const cv::Mat& right) override;

private:
  Parameters parameters_;
};

} // namespace pcl_semantic
