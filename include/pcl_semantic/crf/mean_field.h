// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/crf/crf_model.h>

#include <memory>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Mean-field inference: the distribution Q(x, y) = prod Q_i(x_i) prod Q_c(y_c)
 * that comes near to P(x, y) ~ exp(-E(x, y)), by the updates of eqs. (10) and (11) of
 * the paper.
 *
 * An update takes first every y_c, then every x_i, each time all at once (from the
 * values before). The result does not depend on the number of threads. */
class MeanField {
public:
  using Marginals = Eigen::Ref<const Eigen::MatrixXf>;

  /** \brief Starts at Q(x_i) ~ exp(-psi_i) and Q(y_c) ~ exp(-psi_c).
   * \param[in] model is checked once, here
   * \throws InvalidParameterException as CrfModel::validate() */
  explicit MeanField(CrfModel model);
  ~MeanField();
  MeanField(MeanField&&) noexcept;
  MeanField& operator=(MeanField&&) noexcept;

  /** \brief One update of all variables. */
  void update();

  /** \brief Several updates. \throws InvalidParameterException if \a updates < 0 */
  void run(int updates);

  /** \brief Q(x), L x N, columns sum to one: not a copy, the next update changes it. */
  Marginals marginals() const;

  /** \brief Q(y) of a clique potential of the model, L x C, or (L + 1) x C with the
   * free label last. \throws InvalidParameterException if there is no such potential,
   * or it is P^n Potts and has no y */
  Eigen::MatrixXf cliqueMarginals(std::size_t potential = 0) const;

private:
  class Engine;
  std::unique_ptr<Engine> engine_;
};

} // namespace pcl_semantic
