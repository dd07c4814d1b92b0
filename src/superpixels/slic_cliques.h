// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/superpixels/slic.h>

namespace pcl_semantic {

/** \brief \throws BadInputException if a cloud has points and is not organized */
void requireOrganized(const CliqueGenerator::Cloud& cloud);

/** \brief Superpixels of the colours of an organized cloud, as slicSuperpixels(). */
cv::Mat slicSuperpixels(const CliqueGenerator::Cloud& cloud,
                        const SlicParameters& parameters);

/** \brief Superpixels of an organized cloud's colours as cliques, split at depth
 * discontinuities: every finite point is in exactly one. Points without depth take part
 * in the clustering by their colour. */
class SlicCliques : public CliqueGenerator {
public:
  /** \throws InvalidParameterException as SlicParameters::validate() */
  explicit SlicCliques(const SlicParameters& parameters = SlicParameters());

  bool
  usesColour() const override
  {
    return true;
  }

  /** \throws BadInputException if \a cloud has points and is not organized */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

private:
  SlicParameters parameters_;
};

} // namespace pcl_semantic
