// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/point_features.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Smaller probabilities are raised to this value, because a network's zeros
 * carry no information. */
constexpr float kMinProbability = 1e-4f;

/** \brief One curve per class over a feature, linear between knots and constant beyond
 * them. */
struct ClassCurves {
  Feature feature;
  std::vector<float> knots; ///< rising, two or more
  Eigen::MatrixXf values;   ///< L x knots
};

/** \brief Calibrates a network's probabilities p, using features z of a point:
 * multinomial logistic regression,
 *
 *   p'(l) ~ p(l)^s exp(b_l + sum_z f_lz(z)),
 *
 * temperature and bias as in vector scaling (Guo et al. 2017, "On calibration of modern
 * neural networks") and curves over features. Classes without a fit keep their
 * probability, and the others share the rest. fitCalibration() learns it from ground
 * truth. */
struct LabelCalibration {
  std::string of;                    ///< "pixels" or "cliques"; empty = either
  std::vector<bool> fitted;          ///< per class
  std::vector<Label> ground;         ///< ground classes
  float sharpness = 1.0f;            ///< s
  Eigen::VectorXf bias;              ///< b, L
  std::vector<ClassCurves> curves;   ///< f, of any features in the order of Feature
  std::vector<Eigen::MatrixXf> seen; ///< feature histograms of the training data,
                                     ///< one per curve; empty = unknown
  float usual_distance = 0.0f;       ///< see domainShift(); 0 = unknown

  int
  classes() const
  {
    return static_cast<int>(fitted.size());
  }

  /** \brief The identity for L classes. */
  static LabelCalibration identity(int classes);

  /** \throws InvalidParameterException if sizes do not fit, or a value is not finite or
   * beyond 1e6 */
  void validate() const;
};

/** \brief Calibrates distributions, with the same result for any number of threads.
 * Unlabelled columns stay unlabelled. The curves of an unknown feature are omitted.
 * \param[in] features one per column, or empty if all are unknown
 * \throws InvalidParameterException if sizes do not fit
 * \throws BadInputException at a negative or non-finite probability */
LabelDistributions calibrate(const LabelCalibration& calibration,
                             const LabelDistributions& distributions,
                             const std::vector<PointFeatures>& features);

/** \brief Fraction of a class's pixels at each knot of a feature: L x knots. The class
 * is the network's; a pixel between two knots counts for both in part. Unlabelled
 * pixels and pixels without the feature are ignored; all zero if no others exist. Above
 * 100,000 pixels only every second, third ... is used.
 * \param[in] features one per column of \a distributions */
Eigen::MatrixXf featureHistogram(Feature feature, const std::vector<float>& knots,
                                 const LabelDistributions& distributions,
                                 const std::vector<PointFeatures>& features);

/** \brief Mean total variation between two lists of histograms: 0 = equal, 1 =
 * disjoint. Pairs with an empty histogram are ignored; NaN if no pair is left. */
double histogramDistance(const std::vector<Eigen::MatrixXf>& histograms,
                         const std::vector<Eigen::MatrixXf>& others);

/** \brief Distance of a frame from the training frames of a calibration, by
 * histogramDistance(). 1 = distance of the training sequence least like the others. NaN
 * if the calibration has no histograms or no histogram can be compared.
 * \param[in] features one per column of \a distributions */
double domainShift(const LabelCalibration& calibration,
                   const LabelDistributions& distributions,
                   const std::vector<PointFeatures>& features);

/** \brief Reads a calibration: YAML with classes by name (doc/formats.md).
 * \param[in] of required kind, unless the file states none
 * \throws BadInputException with file and line */
LabelCalibration readCalibration(const std::string& path, const LabelSet& label_set,
                                 const std::string& of = "pixels");

/** \brief Prints a calibration as YAML for readCalibration(), without loss. */
std::string printCalibration(const LabelCalibration& calibration,
                             const LabelSet& label_set);

} // namespace pcl_semantic
