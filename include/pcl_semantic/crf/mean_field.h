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
   * \param[in] initial marginals to start from instead, L x N with columns of any
   * positive scale, as those of an earlier frame; a column of zeros starts as without
   * \throws InvalidParameterException as CrfModel::validate(); if \a initial has
   * another size, or a value that is negative or not finite */
  explicit MeanField(CrfModel model, const Eigen::MatrixXf* initial = nullptr);
  ~MeanField();
  MeanField(MeanField&&) noexcept;
  MeanField& operator=(MeanField&&) noexcept;

  /** \brief One update of all variables.
   * \return the largest change of a marginal, of x or y */
  double update();

  /** \brief Updates until the largest change is at most \a tolerance, but no more than
   * \a max_updates.
   * \param[in] tolerance 0 = never stop early
   * \return the number of updates made
   * \throws InvalidParameterException if an argument is negative or not a number */
  int run(int max_updates, double tolerance = 0.0);

  /** \brief What the last update returned; 0 before the first. */
  double
  lastChange() const
  {
    return last_change_;
  }

  /** \brief Q(x), L x N, columns sum to one: not a copy, the next update changes it. */
  Marginals marginals() const;

  /** \brief Q(y) of a clique potential of the model, L x C, or (L + 1) x C with the
   * free label last. \throws InvalidParameterException if there is no such potential,
   * or it is P^n Potts and has no y */
  Eigen::MatrixXf cliqueMarginals(std::size_t potential = 0) const;

  /** \brief Mean of E(x, y) under Q minus the entropy of Q: KL(Q | P) up to the
   * constant log Z. Energies are those of crf_energy.h. \throws
   * InvalidParameterException if the compatibility is not symmetric */
  double freeEnergy() const;

private:
  class Engine;
  std::unique_ptr<Engine> engine_;
  double last_change_ = 0.0;
};

} // namespace pcl_semantic
