// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/cliques/depth_jumps.h>
#include <pcl_semantic/cliques/slic.h>

namespace pcl_semantic {

/** \brief Superpixels of an organized cloud's colours as cliques, split where they jump
 * in depth: every finite point is in exactly one. Points without depth take part in the
 * clustering by their colour. */
class SlicCliques : public CliqueGenerator {
public:
  SlicCliques() = default;

  /** \throws InvalidParameterException as the parameters' validate() */
  explicit SlicCliques(const SlicParameters& parameters,
                       const DepthJumps& jumps = DepthJumps());

  const SlicParameters&
  parameters() const
  {
    return parameters_;
  }

  bool
  usesColour() const override
  {
    return true;
  }

  /** \throws BadInputException if \a cloud has points and is not organized */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

private:
  SlicParameters parameters_;
  DepthJumps jumps_;
};

} // namespace pcl_semantic
