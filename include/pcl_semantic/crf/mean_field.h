// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/crf/crf_model.h>

#include <memory>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Mean-field inference: approximates P(x, y) ~ exp(-E(x, y)) by Q(x, y) = prod
 * Q_i(x_i) prod Q_c(y_c), with the updates of eqs. (10) and (11) of the paper.
 *
 * An update first computes every y_c, then every x_i, each group in parallel from the
 * previous values. The result does not depend on the number of threads. */
class MeanField {
public:
  using Marginals = Eigen::Ref<const Eigen::MatrixXf>;

  /** \brief Starts at Q(x_i) ~ exp(-psi_i) and Q(y_c) ~ exp(-psi_c).
   * \param[in] model is validated once, here
   * \throws InvalidParameterException as CrfModel::validate() */
  explicit MeanField(CrfModel model);
  ~MeanField();
  MeanField(MeanField&&) noexcept;
  MeanField& operator=(MeanField&&) noexcept;

  void update();

  /** \brief Runs several updates.
   * \throws InvalidParameterException if \a updates < 0 */
  void run(int updates);

  /** \brief Q(x), L x N, columns sum to one. A view, which the next update changes. */
  Marginals marginals() const;

  /** \brief Q(y) of a clique potential of the model, L x C, or (L + 1) x C with the
   * free label last.
   * \throws InvalidParameterException if there is no such potential, or it is P^n Potts
   * and has no y */
  Eigen::MatrixXf cliqueMarginals(std::size_t potential = 0) const;

private:
  class Engine;
  std::unique_ptr<Engine> engine_;
};

} // namespace pcl_semantic
