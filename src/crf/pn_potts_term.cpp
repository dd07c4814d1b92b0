/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "pn_potts_term.h"

#include "robust_term.h"

namespace pcl_semantic {

namespace {

// The product without a member of probability q, from a product as PnPottsTerm keeps
// it.
double
productWithout(double product, double q)
{
  if (q > 0.0)
    return product > 0.0 ? product / q : 0.0;
  return product < 0.0 ? -product : 0.0;
}

} // namespace

std::unique_ptr<CliqueTerm>
makeCliqueTerm(const CliquePotential& potential, bool self_interaction,
               const PaddedColumns& costs)
{
  if (potential.type == CliquePotential::Type::pn_potts)
    return std::make_unique<PnPottsTerm>(potential, costs.rows());
  return std::make_unique<RobustTerm>(potential, self_interaction, costs);
}

PnPottsTerm::PnPottsTerm(const CliquePotential& potential, Eigen::Index labels)
    : potential_(potential), labels_(labels),
      products_(std::size_t(labels) * potential.cliques->size())
{}

void
PnPottsTerm::multiplyMembers(Eigen::Index c, const PaddedColumns& marginals)
{
  double* const product = &products_[std::size_t(c * labels_)];
  std::fill_n(product, labels_, 1.0);
  for (const std::int32_t i : potential_.cliques->members()[std::size_t(c)])
    for (Eigen::Index l = 0; l < labels_; ++l) {
      const float q = marginals.column(i)[l];
      if (q > 0.0f)
        product[l] *= double(q);
      else
        product[l] = product[l] > 0.0 ? -product[l] : 0.0;
    }
}

double
PnPottsTerm::update(const PaddedColumns& marginals)
{
#pragma omp parallel for schedule(dynamic, 16)
  for (std::size_t c = 0; c < potential_.cliques->size(); ++c)
    multiplyMembers(Eigen::Index(c), marginals);
  return 0.0;
}

double
PnPottsTerm::updateSequentially(const PaddedColumns& marginals)
{
  return update(marginals);
}

void
PnPottsTerm::variableChanged(Eigen::Index i, const PaddedColumns& marginals)
{
  for (const std::int32_t c : potential_.cliques->cliques()[std::size_t(i)])
    multiplyMembers(c, marginals);
}

void
PnPottsTerm::addMessages(const PaddedColumns& marginals, Eigen::Index begin,
                         Eigen::Index end, PaddedColumns& messages) const
{
  for (Eigen::Index i = begin; i < end; ++i)
    for (const std::int32_t c : potential_.cliques->cliques()[std::size_t(i)])
      for (Eigen::Index l = 0; l < labels_; ++l)
        messages.column(i)[l] +=
            potential_.weight(l, c) *
            float(productWithout(products_[std::size_t(c * labels_ + l)],
                                 double(marginals.column(i)[l])));
}

double
PnPottsTerm::freeEnergy(const PaddedColumns& marginals) const
{
  double sum = 0.0;
  for (std::size_t c = 0; c < potential_.cliques->size(); ++c) {
    sum += double(potential_.largestWeight(Eigen::Index(c)));
    for (Eigen::Index l = 0; l < labels_; ++l) {
      double product = double(potential_.weight(l, Eigen::Index(c)));
      for (const std::int32_t i : potential_.cliques->members()[c])
        product *= double(marginals.column(i)[l]);
      sum -= product;
    }
  }
  return sum;
}

} // namespace pcl_semantic
