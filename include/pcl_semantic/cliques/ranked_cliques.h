// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Cliques of several generators. A point that is in a clique of one generator
 * leaves the cliques of the later ones, so the cliques of different generators do not
 * overlap. */
class RankedCliques : public CliqueGenerator {
public:
  /** \param[in] generators the first has priority
   * \throws InvalidParameterException if there is none */
  explicit RankedCliques(std::vector<CliqueGenerator::Ptr> generators);

  const std::vector<CliqueGenerator::Ptr>&
  generators() const
  {
    return generators_;
  }

  bool usesColour() const override;

  /** \brief Groups the points.
   * \return the cliques of the first generator, then those of the second, ... */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

private:
  std::vector<CliqueGenerator::Ptr> generators_;
};

/** \brief The generators of RankedCliques, or the generator itself. */
std::vector<CliqueGenerator::Ptr> generatorsOf(const CliqueGenerator::Ptr& generator);

} // namespace pcl_semantic
