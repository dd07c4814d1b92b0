// SPDX-License-Identifier: BSD-3-Clause
#include "pn_potts_term.h"

#include "kernels/column_products.h"

namespace pcl_semantic {

PnPottsTerm::PnPottsTerm(CliquePotential&& potential, const PaddedColumns& marginals)
    : CliqueTerm(std::move(potential), marginals.rows()), labels_(marginals.rows()),
      stride_(marginals.stride()),
      products_(std::size_t(stride_) * potential_.cliques->size())
{}

void
PnPottsTerm::multiplyMembers(Eigen::Index c, const PaddedColumns& marginals)
{
  const IndexLists& members = potential_.cliques->members();
  const std::size_t begin = members.starts[std::size_t(c)];
  columnProducts().multiply(members.indices.data() + begin,
                            members.starts[std::size_t(c) + 1] - begin,
                            members.indices.size() - begin, marginals.column(0),
                            std::size_t(stride_), product(c));
  for (Eigen::Index l = 0; l < stride_; ++l)
    product(c)[l] *= double(weights(c)[l]);
}

double
PnPottsTerm::update(const PaddedColumns& marginals)
{
  const std::size_t count = potential_.cliques->size();
#pragma omp parallel for schedule(dynamic, 8) if (count > 8)
  for (std::size_t c = 0; c < count; ++c)
    multiplyMembers(Eigen::Index(c), marginals);
  return 0.0;
}

void
PnPottsTerm::addMessages(const PaddedColumns& marginals, Eigen::Index begin,
                         Eigen::Index end, PaddedColumns& messages) const
{
  const IndexLists& cliques = potential_.cliques->cliques();
  columnProducts().add_without(cliques.starts.data() + begin, cliques.indices.data(),
                               std::size_t(end - begin), products_.data(),
                               marginals.column(begin), std::size_t(stride_),
                               messages.column(begin));
}

double
PnPottsTerm::freeEnergy(const PaddedColumns& marginals) const
{
  const auto count = Eigen::Index(potential_.cliques->size());
  return orderedSum(count, 64, [&](Eigen::Index c) {
    auto cost = double(potential_.largestWeight(c));
    for (Eigen::Index l = 0; l < labels_; ++l) {
      auto product = double(weights(c)[l]);
      for (const std::int32_t i : potential_.cliques->members()[std::size_t(c)])
        product *= double(marginals.column(i)[l]);
      cost -= product;
    }
    return cost;
  });
}

} // namespace pcl_semantic
