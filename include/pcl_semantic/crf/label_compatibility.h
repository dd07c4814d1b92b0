// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief mu(l, l'), what two linked variables pay for labels l and l', eq. (5) of the
 * paper. */
class LabelCompatibility {
public:
  /** \brief Potts: mu(l, l') = 1 if l != l', else 0, for any number of labels. */
  LabelCompatibility() = default;

  /** \brief Any costs.
   * \param[in] costs L x L; a negative cost attracts
   * \throws InvalidParameterException unless \a costs is square and not empty, and its
   * values are within +-1e9 */
  explicit LabelCompatibility(Eigen::MatrixXf costs);

  /** \brief Potts, also if it was given as a matrix. */
  bool
  isPotts() const
  {
    return is_potts_;
  }

  /** \brief mu(l, l') = mu(l', l) for all labels, to the last bit. Updates do without;
   * an energy needs it. */
  bool
  isSymmetric() const
  {
    return is_symmetric_;
  }

  /** \brief L; 0 = any number. */
  Eigen::Index
  labels() const
  {
    return costs_.rows();
  }

  /** \brief mu(l, k), labels counted from 0. */
  float
  cost(Eigen::Index l, Eigen::Index k) const
  {
    return costs_.size() > 0 ? costs_(l, k) : float(l != k);
  }

private:
  Eigen::MatrixXf costs_; // empty = Potts for any number of labels
  bool is_potts_ = true;
  bool is_symmetric_ = true;
};

} // namespace pcl_semantic
