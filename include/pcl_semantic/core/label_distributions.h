// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief One probability distribution over the classes for every point of a cloud or
 * pixel of an image.
 *
 * L x N, single precision, column-major: column j belongs to point j, row k is class
 * k + 1. A column sums to one, or is all zero: unlabelled. This is the one place that
 * normalises distributions, fuses them and takes their entropy. */
class LabelDistributions {
public:
  using Matrix = Eigen::MatrixXf;

  LabelDistributions() = default;

  /** \brief \a count unlabelled columns.
   * \throws InvalidParameterException unless \a classes is 1 to 255 */
  LabelDistributions(int classes, Eigen::Index count);

  /** \brief Takes weights (any positive scale) and normalises them.
   * \throws BadInputException as normalize() */
  explicit LabelDistributions(Matrix weights);

  int
  classes() const
  {
    return static_cast<int>(matrix_.rows());
  }

  Eigen::Index
  size() const
  {
    return matrix_.cols();
  }

  bool
  empty() const
  {
    return matrix_.size() == 0;
  }

  const Matrix&
  matrix() const
  {
    return matrix_;
  }

  Matrix&
  matrix()
  {
    return matrix_;
  }

  const float*
  column(Eigen::Index j) const
  {
    return matrix_.data() + j * matrix_.rows();
  }

  float*
  column(Eigen::Index j)
  {
    return matrix_.data() + j * matrix_.rows();
  }

  /** \brief Puts all of \a confidence on \a label and spreads the rest evenly over the
   * other classes; kUnlabelled clears the column.
   * \param[in] confidence 0..1
   * \throws BadInputException if \a label is beyond L
   * \throws InvalidParameterException if \a confidence is not within 0..1 */
  void setLabel(Eigen::Index j, Label label, float confidence);

  /** \brief Makes every column sum to one; all-zero columns, and those that sum to one
   * but for rounding (1e-6), stay as they are.
   * \throws BadInputException that names the column, at a negative or non-finite value
   */
  void normalize();

  /** \brief The class of largest probability (the smallest number of equals);
   * kUnlabelled for an all-zero column. */
  Label mapLabel(Eigen::Index j) const;

  /** \brief Shannon entropy of column \a j [nat]; log L for an unlabelled column. */
  float entropy(Eigen::Index j) const;

private:
  Matrix matrix_;
};

/** \brief MAP label of \a classes probabilities; kUnlabelled if all are zero. */
Label mapLabel(const float* distribution, int classes);

/** \brief Multiplies a distribution by a likelihood in log space, eq. (1) of the paper:
 * \a log_distribution += \a log_likelihood, shifted so that its largest entry is 0 and
 * clamped from below at -\a max_log_ratio, so that later evidence can still turn it. */
void fuseLogLikelihood(const float* log_likelihood, int classes, float max_log_ratio,
                       float* log_distribution);

/** \brief Distribution from unnormalised log-probabilities (soft-max, computed without
 * overflow). \a log_values and \a distribution may be the same array. */
void distributionFromLog(const float* log_values, int classes, float* distribution);

} // namespace pcl_semantic
