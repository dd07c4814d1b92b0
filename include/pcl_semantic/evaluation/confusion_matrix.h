// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Counts of pixels by ground truth and predicted label, including 0 (no ground
 * truth, not covered). Add matrices to pool images. */
class ConfusionMatrix {
public:
  /** \param[in] classes L, labels go from 0 to L
   * \throws InvalidParameterException unless it is 1 to 255 */
  explicit ConfusionMatrix(int classes);

  int
  classes() const
  {
    return classes_;
  }

  /** \brief Number of pixels of class \a truth that were predicted as \a prediction. */
  std::uint64_t
  operator()(Label truth, Label prediction) const
  {
    return counts_[std::size_t(truth) * (classes_ + 1) + prediction];
  }

  /** \brief Counts the pixels of an image.
   * \param[in] truth CV_8UC1, 0 = no ground truth
   * \param[in] prediction CV_8UC1 of the same size, 0 = not covered
   * \param[in] covered_by if not empty: CV_8UC1 of the same size, a mask of the pixels
   * that count
   * \throws BadInputException for another size or type, or for a label beyond L;
   * nothing is counted then */
  void add(const cv::Mat& truth, const cv::Mat& prediction,
           const cv::Mat& covered_by = {});

  /** \brief Adds \a count pixels with the same labels.
   * \throws InvalidParameterException for a label beyond L */
  void add(Label truth, Label prediction, std::uint64_t count);

  /** \throws InvalidParameterException if \a other has another number of classes */
  ConfusionMatrix& operator+=(const ConfusionMatrix& other);

private:
  int classes_;
  std::vector<std::uint64_t> counts_; ///< (L + 1) x (L + 1), rows are the ground truth
};

/** \brief Scores of one class. Ratios are 0..1, or NaN if undefined: the exclusive ones
 * of a class without covered ground truth pixels, the inclusive one of a class without
 * ground truth, the precision of a class that was never predicted. */
struct ClassScores {
  Label label = kUnlabelled;
  std::uint64_t pixels = 0;   ///< of the ground truth
  std::uint64_t covered = 0;  ///< of these, predicted as any class
  double iou_exclusive = 0.0; ///< TP / (TP + FN + FP) over covered pixels
  double iou_inclusive = 0.0; ///< the same with uncovered pixels as false negatives
  double recall = 0.0;        ///< TP / (TP + FN) over covered pixels
  double precision = 0.0;     ///< TP / (TP + FP), called accuracy in the paper
};

/** \brief Scores over the evaluated classes. */
struct Scores {
  std::vector<ClassScores> classes; ///< in the order given to computeScores()
  /// Sums of pixels, and means of the scores over the classes in the ground truth. All
  /// scores but the inclusive IoU are means over the classes with a covered pixel only.
  /// The precision of a class that was never predicted counts as 0.
  ClassScores mean;
  double global_accuracy = 0.0;        ///< fraction of covered pixels that are correct
  double frequency_weighted_iou = 0.0; ///< exclusive, weighted by covered pixels
  double coverage = 0.0; ///< fraction of ground truth pixels that are covered
};

/** \brief Computes the scores of a confusion matrix.
 *
 * Only pixels whose ground truth is an evaluated class count. If the prediction is not
 * an evaluated class, the pixel is a false negative and no false positive.
 * \param[in] confusion counts
 * \param[in] evaluated the classes that count
 * \throws InvalidParameterException if a class is 0 or beyond L */
Scores computeScores(const ConfusionMatrix& confusion,
                     const std::vector<Label>& evaluated);

/** \brief Formats scores as an aligned text table, in percent. */
std::string scoresTable(const Scores& scores, const LabelSet& label_set);

/** \brief The two header lines for scoresMarkdownRow(). */
std::string scoresMarkdownHeader(const Scores& scores, const LabelSet& label_set);

/** \brief Formats one row of a Markdown table in percent: name, exclusive IoU of each
 * class and their mean, global accuracy, mean inclusive IoU, coverage; "-" for
 * undefined scores. */
std::string scoresMarkdownRow(const Scores& scores, const std::string& name);

/** \brief Formats scores as JSON; ratios are 0..1, null if undefined. */
std::string scoresJson(const Scores& scores, const LabelSet& label_set);

/** \brief Formats all counts as CSV: one row per ground truth label, one column per
 * predicted label. */
std::string confusionCsv(const ConfusionMatrix& confusion, const LabelSet& label_set);

} // namespace pcl_semantic
