// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/label_set.h>

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether class probabilities are as often right as they say: pixels with
 * ground truth, counted by the probability that they were given, in 15 bins of equal
 * width (Naeini et al. 2015; Guo et al. 2017, "On calibration of modern neural
 * networks"). Pooling is adding. */
class Reliability {
public:
  static constexpr int kBins = 15;

  /** \brief Pixels whose probability lies in one bin. */
  struct Bin {
    std::uint64_t pixels = 0;
    std::uint64_t right = 0;  ///< of these, of the class that the probability is of
    double probability = 0.0; ///< sum over the pixels

    double
    meanProbability() const
    {
      return probability / double(pixels);
    }

    double
    frequency() const
    {
      return double(right) / double(pixels);
    }

    Bin& operator+=(const Bin& other);
  };

  using Curve = std::vector<Bin>; ///< kBins

  /** \brief Counts a probability that was right, or was not. */
  static void count(float probability, bool is_right, Curve& curve);

  /** \param[in] classes L
   * \param[in] evaluated only pixels whose ground truth is one of them count
   * \throws InvalidParameterException if a class is 0 or beyond L */
  Reliability(int classes, const std::vector<Label>& evaluated);

  /** \brief Counts the pixels of an image; unlabelled columns are passed over.
   * \param[in] truth CV_8UC1, 0 = no ground truth
   * \param[in] predicted L x (width * height), pixels row by row
   * \throws BadInputException if the sizes differ; nothing is counted then */
  void add(const cv::Mat& truth, const LabelDistributions& predicted);

  /** \throws InvalidParameterException if \a other has other classes */
  Reliability& operator+=(const Reliability& other);

  /** \brief Of the most probable class of each pixel: its probability is the pixel's
   * confidence. */
  const Curve&
  ofConfidence() const
  {
    return curves_[0];
  }

  /** \brief Of one class, over all pixels. */
  const Curve&
  of(Label label) const
  {
    return curves_[label];
  }

  const std::vector<Label>&
  evaluated() const
  {
    return evaluated_;
  }

private:
  int classes_;
  std::vector<Label> evaluated_;
  std::vector<bool> is_evaluated_; // by label
  std::vector<Curve> curves_;      // by label, 0 = of the confidence
};

/** \brief Expected calibration error, 0..1: the mean over the pixels of |frequency -
 * mean probability| of their bin; NaN without a pixel. */
double expectedCalibrationError(const Reliability::Curve& curve);

/** \brief The errors of the confidence and of each class as an aligned table of text,
 * in percent. */
std::string reliabilityTable(const Reliability& reliability, const LabelSet& label_set);

/** \brief Errors and bins as JSON; ratios are 0..1, null where there is none. */
std::string reliabilityJson(const Reliability& reliability, const LabelSet& label_set);

/** \brief The reliability diagram of the confidence, and of each class in its colour:
 * how often the probability was right, over the probability. On the diagonal it is
 * honest, below it too sure. \return CV_8UC3 */
cv::Mat reliabilityDiagram(const Reliability& reliability, const LabelSet& label_set);

} // namespace pcl_semantic
