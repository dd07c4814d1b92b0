// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/point_features.h>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Smaller probabilities are raised to this one: a network's zeros carry no
 * information. */
constexpr float kMinProbability = 1e-4f;

/** \brief A curve for each class over a feature, linear between knots and level beyond
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
 * neural networks") and curves over features. Classes that it was not fitted for keep
 * their probability, and the others share what is left. fitCalibration() makes one from
 * ground truth. */
struct LabelCalibration {
  std::string of;                    ///< "pixels" or "cliques"; empty = of either
  std::vector<bool> fitted;          ///< of each class
  std::vector<Label> ground;         ///< classes that the ground is made of
  float sharpness = 1.0f;            ///< s
  Eigen::VectorXf bias;              ///< b, L
  std::vector<ClassCurves> curves;   ///< f, of any features in the order of Feature
  std::vector<Eigen::MatrixXf> seen; ///< what it was learned from, a featureHistogram()
                                     ///< for each of the curves; empty = not known
  float usual_distance = 0.0f;       ///< from there, see domainShift(); 0 = not known

  int
  classes() const
  {
    return static_cast<int>(fitted.size());
  }

  /** \brief One for L classes that changes nothing. */
  static LabelCalibration identity(int classes);

  /** \throws InvalidParameterException if sizes do not fit or a value is not finite, or
   * beyond 1e6 */
  void validate() const;
};

/** \brief Calibrates distributions; the same for any number of threads. Unlabelled
 * columns stay so; where a feature is not known its curves are left out.
 * \param[in] features one a column, or empty: nothing is known
 * \throws InvalidParameterException if sizes do not fit
 * \throws BadInputException at a negative or non-finite probability */
LabelDistributions calibrate(const LabelCalibration& calibration,
                             const LabelDistributions& distributions,
                             const std::vector<PointFeatures>& features);

/** \brief Where the pixels of a frame lie: L x knots, the fraction of them that the
 * network takes for a class, at each knot (between two, at both in part). Pixels that
 * are unlabelled, or of which the feature is not known, do not count; all zero if there
 * are no others. Of more than 100,000 pixels every second, third ... is taken.
 * \param[in] features one a column of \a distributions */
Eigen::MatrixXf featureHistogram(Feature feature, const std::vector<float>& knots,
                                 const LabelDistributions& distributions,
                                 const std::vector<PointFeatures>& features);

/** \brief How much two lists of histograms differ: total variation, 0 = the same, 1 =
 * nothing in common, the mean over those that neither has empty; NaN if there are none.
 */
double histogramDistance(const std::vector<Eigen::MatrixXf>& histograms,
                         const std::vector<Eigen::MatrixXf>& others);

/** \brief How far a frame is from those that a calibration was learned from, by
 * histogramDistance(): 1 = as far as the one of their sequences that is least like the
 * others. NaN if the calibration does not say what it has seen, or the frame has
 * nothing to compare. \param[in] features one a column of \a distributions */
double domainShift(const LabelCalibration& calibration,
                   const LabelDistributions& distributions,
                   const std::vector<PointFeatures>& features);

/** \brief Reads a calibration: YAML with classes by name (doc/formats.md).
 * \param[in] of what it has to be of, unless it does not say so
 * \throws BadInputException with file and line */
LabelCalibration readCalibration(const std::string& path, const LabelSet& label_set,
                                 const std::string& of = "pixels");

/** \brief A calibration as YAML that readCalibration() takes, without loss. */
std::string printCalibration(const LabelCalibration& calibration,
                             const LabelSet& label_set);

} // namespace pcl_semantic
