// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/point_features.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief One curve per class over a feature. A curve is linear between its knots and
 * constant beyond the first and the last. */
struct ClassCurves {
  Feature feature;
  std::vector<float> knots; ///< rising, two or more
  Eigen::MatrixXf values;   ///< L x knots
};

/** \brief A calibration of a network's probabilities p. It uses features z of a point,
 * and is a multinomial logistic regression (~ means proportional to):
 *
 *   p'(l) ~ p(l)^s exp(b_l + sum_z f_lz(z))
 *
 * Sharpness s and bias b_l are those of vector scaling with one temperature 1 / s (Guo
 * et al. 2017, "On calibration of modern neural networks"). f_lz are curves over the
 * features. A class without a fit keeps its probability. The fitted classes share the
 * remaining probability. python/lab/calibrate.py learns a calibration. */
struct LabelCalibration {
  std::vector<bool> fitted;        ///< per class: true if it was fitted
  std::vector<Label> ground;       ///< classes of the ground
  float sharpness = 1.0f;          ///< s
  Eigen::VectorXf bias;            ///< b, L
  std::vector<ClassCurves> curves; ///< f, in the order of Feature, which may have gaps
  std::vector<Eigen::MatrixXf> seen; ///< feature histograms of the training data,
                                     ///< one per curve; empty = unknown
  float usual_distance = 0.0f;       ///< divisor of domainShift(); 0 = unknown

  int
  classes() const
  {
    return static_cast<int>(fitted.size());
  }

  /** \brief A calibration of L classes that changes probabilities only by the
   * clamp at 1e-4. */
  static LabelCalibration identity(int classes);

  /** \throws InvalidParameterException unless the bias has L values and each curve L x
   * knots, or if a value is not finite or beyond 1e6 */
  void validate() const;
};

/** \brief Calibrates distributions. The result does not depend on the number of
 * threads. Unlabelled columns stay unlabelled. A curve is omitted where its feature is
 * unknown.
 * \param[in] distributions L x points
 * \param[in] features one per column, or empty if all are unknown
 * \throws InvalidParameterException unless the calibration is of L classes and \a
 * features has one entry per column or none
 * \throws BadInputException at a negative or non-finite probability */
LabelDistributions calibrate(const LabelCalibration& calibration,
                             const LabelDistributions& distributions,
                             const std::vector<PointFeatures>& features);

/** \brief Computes the fraction of the pixels in each class and at each knot of a
 * feature. The class is the most probable one of the network.
 *
 * A pixel between two knots counts for both by linear interpolation. Unlabelled pixels
 * and pixels without the feature are ignored. From 100,000 pixels on, only every second
 * pixel is used, from 200,000 on every third, and so on.
 * \param[in] features one per column of \a distributions
 * \return L x knots with sum 1, or all zero without a usable pixel */
Eigen::MatrixXf featureHistogram(Feature feature, const std::vector<float>& knots,
                                 const LabelDistributions& distributions,
                                 const std::vector<PointFeatures>& features);

/** \brief Mean total variation distance between the histograms of two lists at the same
 * positions: 0 = equal, 1 = disjoint. Pairs with an empty histogram are ignored. NaN if
 * no pair remains. */
double histogramDistance(const std::vector<Eigen::MatrixXf>& histograms,
                         const std::vector<Eigen::MatrixXf>& others);

/** \brief Distance of a frame from the training frames of a calibration, by
 * histogramDistance(). It is divided by LabelCalibration::usual_distance, the largest
 * distance of a training sequence from the other training sequences.
 * \param[in] features one per column of \a distributions
 * \return NaN if the calibration has no histograms or no histogram can be compared */
double domainShift(const LabelCalibration& calibration,
                   const LabelDistributions& distributions,
                   const std::vector<PointFeatures>& features);

/** \brief Reads a calibration from a YAML file with classes by name (doc/formats.md).
 * \param[in] label_set the classes that the file may name
 * \throws BadInputException that names file and line, if the file is invalid */
LabelCalibration readCalibration(const std::string& path, const LabelSet& label_set);

} // namespace pcl_semantic
