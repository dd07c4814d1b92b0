// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/cliques/clique_generator.h>

#include "core/fail.h"

#include <pcl_semantic/core/position_steps.h>

namespace pcl_semantic {

void
CliqueGenerator::extract(std::vector<pcl::PointIndices>& cliques)
{
  if (!input_)
    badParameter("cliques: there is no input cloud");
  if (!indices_ || fake_indices_) {
    cliques = generate(*input_);
  }
  else {
    for (const pcl::index_t i : *indices_)
      if (i < 0 || std::size_t(i) >= input_->size())
        badParameter("cliques: index ", i, " is beyond the ", input_->size(),
                     " points of the cloud");
    const Cloud::ConstPtr means = means_;
    try {
      if (means)
        means_ = std::make_shared<Cloud>(meansOr(*input_), *indices_);
      cliques = generate(Cloud(*input_, *indices_));
    }
    catch (...) {
      means_ = means;
      throw;
    }
    means_ = means;
    for (pcl::PointIndices& clique : cliques)
      for (pcl::index_t& i : clique.indices)
        i = (*indices_)[std::size_t(i)];
  }
  for (pcl::PointIndices& clique : cliques)
    clique.header = input_->header;
}

void
CliqueGenerator::configure(CliqueGenerator& other) const
{
  other.origin_ = origin_;
  other.judges_steps_ = judges_steps_;
  other.means_ = means_;
  other.voxel_size_ = voxel_size_;
}

const CliqueGenerator::Cloud&
CliqueGenerator::meansOr(const Cloud& cloud) const
{
  if (!means_)
    return cloud;
  if (means_->size() != cloud.size())
    badParameter("cliques: ", means_->size(), " mean positions for a cloud of ",
                 cloud.size(), " points");
  return *means_;
}

void
CliqueGenerator::judgeSteps(const std::string& generator, const Cloud& cloud) const
{
  if (judges_steps_)
    warnOfDoubt(generator, doubtOfSteps(cloud, "cloud"));
}

} // namespace pcl_semantic
