/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/labelling/label_calibration.h>

namespace pcl_semantic {

/** \brief Points whose class is known. */
struct CalibrationSamples {
  LabelDistributions network; ///< L x N
  std::vector<PointGeometry> geometry;
  std::vector<Label> truth; ///< kUnlabelled ones do not count
};

struct CalibrationOptions {
  /// Each class weighs as its number of samples to the power of 1 - balance: 0 = every
  /// sample counts alike, 1 = every class.
  double balance = 0.5;
  double bias_penalty = 0.01;   ///< on b^2, in mean log-likelihood
  double curve_penalty = 0.003; ///< on the squared values of the curves
  std::vector<float> height{-0.5f, -0.15f, 0.0f, 0.1f, 0.2f, 0.4f,
                            0.8f,  1.4f,   2.0f, 3.0f, 5.0f};           ///< knots [m]
  std::vector<float> distance{5.0f, 10.0f, 15.0f, 20.0f, 30.0f, 40.0f}; ///< knots [m]
  std::vector<float> level{0.0f, 0.3f, 0.6f, 0.85f, 1.0f};              ///< knots
  int iterations = 300; ///< of the optimisation, at most

  /** \throws InvalidParameterException that names the option and its range */
  void validate() const;
};

/** \brief The calibration of largest penalised likelihood, the sum over samples of
 * log p'(truth): convex, so there is but one. Classes that the truth does not have are
 * not fitted, and the sharpness is never below 0. \a ground of the result is empty.
 * \throws InvalidParameterException if sizes do not fit
 * \throws BadInputException if there are no samples of two classes or more */
LabelCalibration fitCalibration(const CalibrationSamples& samples,
                                const CalibrationOptions& options);

} // namespace pcl_semantic
