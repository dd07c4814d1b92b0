// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/labelling/label_calibration.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Points whose class is known. */
struct CalibrationSamples {
  LabelDistributions network; ///< L x N
  std::vector<PointFeatures> features;
  std::vector<Label> truth;   ///< kUnlabelled ones do not count
  std::vector<float> weights; ///< how often each counts, more than 0; empty = once
  std::vector<int> sequences; ///< the sequence each is of, from 0; empty = one
  std::string of = "pixels";  ///< what they are, see LabelCalibration
  std::vector<std::vector<Eigen::MatrixXf>>
      frames; ///< of each frame that they are of a
              ///< featureHistogram() for each of
              ///< the curves; empty = not known

  /** \throws InvalidParameterException if sizes do not fit, a label is not one of the
   * classes, or a weight or sequence cannot be */
  void validate() const;
};

/** \brief Where the curves over a feature bend. */
struct FeatureKnots {
  Feature feature;
  std::vector<float> knots; ///< rising, two or more
};

/** \brief The features of pixels that are worth a curve (doc/calibration.md). */
const std::vector<Feature>& pixelFeatures();

/** \brief Those of cliques. */
const std::vector<Feature>& cliqueFeatures();

/** \brief Knots that are dense where a feature tells the classes of a street apart, for
 * features in any order; one that comes twice counts once. */
std::vector<FeatureKnots> streetKnots(const std::vector<Feature>& features);

struct CalibrationOptions {
  /// Every sequence counts alike. In it each class weighs as its number of samples to
  /// the power of 1 - balance: 0 = every sample counts alike, 1 = every class.
  double balance = 0.5;
  /// What is taken off bias and curves afterwards: another street is only in part like
  /// those they were learned from. 0 = nothing, 1 = the sharpness alone is left.
  double shrinkage = 0.5;
  double bias_penalty = 0.001;   ///< on b^2, in mean log-likelihood
  double curve_penalty = 0.0003; ///< on the squared values of the curves
  std::vector<FeatureKnots> curves = streetKnots(pixelFeatures()); ///< by feature
  int iterations = 300; ///< of the optimisation, at most

  /** \throws InvalidParameterException that names the option and its range */
  void validate() const;
};

/** \brief The calibration of largest penalised likelihood, the sum over samples of
 * log p'(truth): convex, so there is but one. Then \a shrinkage is applied. Classes
 * that the ground truth does not have are not fitted, and the sharpness is never below
 * 0. \a ground of the result is empty. \throws InvalidParameterException if sizes do
 * not fit \throws BadInputException if there are no samples of two classes or more */
LabelCalibration fitCalibration(const CalibrationSamples& samples,
                                const CalibrationOptions& options);

} // namespace pcl_semantic
