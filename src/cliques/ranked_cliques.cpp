// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/cliques/ranked_cliques.h>

#include "core/fail.h"

#include <algorithm>
#include <utility>

namespace pcl_semantic {

RankedCliques::RankedCliques(std::vector<CliqueGenerator::Ptr> generators)
    : generators_(std::move(generators))
{
  if (generators_.empty())
    badParameter("ranked cliques: there is no generator");
  for (const CliqueGenerator::Ptr& each : generators_)
    if (!each)
      badParameter("ranked cliques: a generator is null");
}

bool
RankedCliques::usesColour() const
{
  return std::any_of(generators_.begin(), generators_.end(),
                     [](const auto& each) { return each->usesColour(); });
}

std::vector<pcl::PointIndices>
RankedCliques::generate(const Cloud& cloud)
{
  std::vector<pcl::PointIndices> cliques;
  std::vector<bool> is_taken(cloud.size(), false);
  for (const CliqueGenerator::Ptr& generator : generators_) {
    configure(*generator);
    const std::size_t before = cliques.size();
    for (pcl::PointIndices& clique : generator->generate(cloud)) {
      pcl::Indices& members = clique.indices;
      members.erase(
          std::remove_if(members.begin(), members.end(),
                         [&](pcl::index_t i) { return is_taken[std::size_t(i)]; }),
          members.end());
      if (!members.empty())
        cliques.push_back(std::move(clique));
    }
    for (std::size_t c = before; c < cliques.size(); ++c)
      for (const pcl::index_t i : cliques[c].indices)
        is_taken[std::size_t(i)] = true;
  }
  return cliques;
}

std::vector<CliqueGenerator::Ptr>
generatorsOf(const CliqueGenerator::Ptr& generator)
{
  if (const auto ranked = std::dynamic_pointer_cast<RankedCliques>(generator))
    return ranked->generators();
  return {generator};
}

} // namespace pcl_semantic
