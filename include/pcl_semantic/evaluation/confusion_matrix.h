// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Counts of pixels by true and predicted label, 0 (no ground truth, not
 * covered) included. Pooling is adding matrices. */
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
   * \param[in] covered_by if not empty: CV_8UC1 of the same size, only pixels where it
   * is not 0 count \throws BadInputException at another size or type, or at a label
   * beyond L; nothing is counted then */
  void add(const cv::Mat& truth, const cv::Mat& prediction,
           const cv::Mat& covered_by = {});

  /** \brief Counts some pixels of one kind.
   * \throws InvalidParameterException at a label beyond L */
  void add(Label truth, Label prediction, std::uint64_t count);

  /** \throws InvalidParameterException if \a other has another number of classes */
  ConfusionMatrix& operator+=(const ConfusionMatrix& other);

private:
  int classes_;
  std::vector<std::uint64_t> counts_; ///< (L + 1) x (L + 1), rows are the ground truth
};

/** \brief How well one class was found. Ratios are 0..1, NaN where there is nothing to
 * say: the exclusive ones of a class without a covered pixel of ground truth, the
 * inclusive one of a class that is not in the ground truth, the precision of a class
 * never predicted. */
struct ClassScores {
  Label label = kUnlabelled;
  std::uint64_t pixels = 0;   ///< of the ground truth
  std::uint64_t covered = 0;  ///< of these, predicted as any class
  double iou_exclusive = 0.0; ///< TP / (TP + FN + FP) over covered pixels
  double iou_inclusive = 0.0; ///< uncovered pixels are false negatives
  double recall = 0.0;        ///< TP / (TP + FN) over covered pixels
  double precision = 0.0;     ///< TP / (TP + FP), what the paper calls accuracy
};

/** \brief Figures over the evaluated classes. */
struct Scores {
  std::vector<ClassScores> classes; ///< in the order of their labels
  ClassScores mean;             ///< over the classes present in the ground truth; the
                                ///< exclusive ones over those with a covered pixel
  double global_accuracy = 0.0; ///< covered pixels that are right
  double frequency_weighted_iou = 0.0; ///< exclusive, weighted by covered pixels
  double coverage = 0.0; ///< fraction of ground truth pixels that are covered
};

/** \brief Scores of a confusion matrix.
 *
 * Only pixels whose ground truth is an evaluated class count. Predictions of other
 * classes are misses there, and false positives of none. \param[in] confusion counts
 * \param[in] evaluated the classes that count
 * \throws InvalidParameterException if a class is 0 or beyond L */
Scores computeScores(const ConfusionMatrix& confusion,
                     const std::vector<Label>& evaluated);

/** \brief Scores as an aligned table of text, figures in percent. */
std::string scoresTable(const Scores& scores, const LabelSet& label_set);

/** \brief The two header lines that belong to scoresMarkdownRow. */
std::string scoresMarkdownHeader(const Scores& scores, const LabelSet& label_set);

/** \brief One row of a Markdown table in percent: name, exclusive IoU of each class and
 * their mean, global accuracy, mean inclusive IoU, coverage; "-" for what is not there.
 */
std::string scoresMarkdownRow(const Scores& scores, const std::string& name);

/** \brief Scores as JSON; ratios are 0..1, null where there is none. */
std::string scoresJson(const Scores& scores, const LabelSet& label_set);

/** \brief All counts as CSV: a row a true label, a column a predicted one. */
std::string confusionCsv(const ConfusionMatrix& confusion, const LabelSet& label_set);

} // namespace pcl_semantic
