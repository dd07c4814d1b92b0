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
 * L x N, single precision, column-major: column j belongs to point j, row k is class k
 * + 1. A column sums to one, or is all zero (unlabelled). */
class LabelDistributions {
public:
  using Matrix = Eigen::MatrixXf;

  LabelDistributions() = default;

  /** \brief Makes \a count unlabelled columns.
   * \throws InvalidParameterException unless \a classes is 1 to 255 */
  LabelDistributions(int classes, Eigen::Index count);

  /** \brief Takes weights of any positive scale and normalises them.
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

  /** \brief Assigns probability \a confidence to \a label and spreads the rest evenly
   * over the other classes; kUnlabelled clears the column.
   * \param[in] confidence 0..1
   * \throws BadInputException if \a label exceeds L
   * \throws InvalidParameterException if \a confidence is outside 0..1 */
  void setLabel(Eigen::Index j, Label label, float confidence);

  /** \brief Makes every column sum to one. All-zero columns and columns that already
   * sum to one within 1e-6 stay unchanged.
   * \throws BadInputException that names the column, for a negative or non-finite value
   */
  void normalize();

  /** \brief The most probable class (the smallest number in a tie); kUnlabelled for an
   * all-zero column. */
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
 * clamped from below at -\a max_log_ratio. The clamp lets later measurements still
 * change the label. */
void fuseLogLikelihood(const float* log_likelihood, int classes, float max_log_ratio,
                       float* log_distribution);

/** \brief Computes a distribution from unnormalised log-probabilities (soft-max without
 * overflow). \a log_values and \a distribution may be the same array. */
void distributionFromLog(const float* log_values, int classes, float* distribution);

} // namespace pcl_semantic
