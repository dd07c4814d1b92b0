// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/labelling/label_calibration.h>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Points with ground truth. */
struct CalibrationSamples {
  LabelDistributions network; ///< L x N
  std::vector<PointFeatures> features;
  std::vector<Label> truth;   ///< kUnlabelled ones do not count
  std::vector<float> weights; ///< multiplicity of each, more than 0; empty = 1
  std::vector<int> sequences; ///< sequence of each, from 0; empty = one sequence
  std::string of = "pixels";  ///< kind of samples, see LabelCalibration
  std::vector<std::vector<Eigen::MatrixXf>> frames; ///< a featureHistogram() per frame
                                                    ///< of the samples and per curve;
                                                    ///< empty = unknown

  /** \throws InvalidParameterException unless all lists have one entry per sample (or
   * none, where empty is allowed), a label exceeds L, or a weight or sequence is
   * invalid */
  void validate() const;
};

/** \brief Knots of the curves over a feature. */
struct FeatureKnots {
  Feature feature;
  std::vector<float> knots; ///< rising, two or more
};

/** \brief Features of pixels for which a curve improves the result
 * (doc/calibration.md). */
const std::vector<Feature>& pixelFeatures();

/** \brief Features of cliques for which a curve improves the result. */
const std::vector<Feature>& cliqueFeatures();

/** \brief Knots that are dense where a feature separates the classes of a street. The
 * order of the features is free; duplicates are ignored. */
std::vector<FeatureKnots> streetKnots(const std::vector<Feature>& features);

struct CalibrationOptions {
  /// Exponent 1 - balance of the class weights: in a sequence, a class weighs its
  /// number of samples to this power. 0 = equal samples, 1 = equal classes. Sequences
  /// have equal weights.
  double balance = 0.5;
  /// Fraction subtracted from bias and curves after the fit, because a new street
  /// resembles the training sequences only partly. 0 = none, 1 = only the sharpness is
  /// left.
  double shrinkage = 0.5;
  double bias_penalty = 0.001;   ///< on b^2, in mean log-likelihood
  double curve_penalty = 0.0003; ///< on the squared values of the curves
  std::vector<FeatureKnots> curves = streetKnots(pixelFeatures()); ///< by feature
  int iterations = 300; ///< maximum, of the optimisation

  /** \throws InvalidParameterException that names the option and its range */
  void validate() const;
};

/** \brief Fits a calibration by maximum penalised likelihood: the sum over samples of
 * log p'(ground truth). The problem is convex, so the solution is unique. Then \a
 * shrinkage is applied. Classes without ground truth are not fitted, and the sharpness
 * is at least 0. \a ground of the result is empty.
 * \throws InvalidParameterException as CalibrationSamples::validate()
 * \throws BadInputException unless there are samples of at least two classes */
LabelCalibration fitCalibration(const CalibrationSamples& samples,
                                const CalibrationOptions& options);

} // namespace pcl_semantic
