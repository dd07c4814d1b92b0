// SPDX-License-Identifier: BSD-3-Clause
#include "map_cliques.h"

#include <pcl/common/io.h>

#include <algorithm>

namespace pcl_semantic {

namespace {

// Voxels with a higher probability of the classes in clique_exclude join no clique.
constexpr float kExcludeThreshold = 0.3f;

} // namespace

MapCliques::MapCliques(const MapperConfig& config, const LabelSet& label_set)
    : generator_(makeCliqueGenerator(config.cliques, config.clique_parameters)),
      superpixels_(std::dynamic_pointer_cast<SuperpixelCliques>(generator_)),
      left_out_(listedLabels(config.clique_exclude, label_set, "clique_exclude"))
{
  generator_->setOrigin(Eigen::Vector3d::Zero());
}

void
MapCliques::setFrame(const pcl::PointCloud<pcl::PointXYZRGB>::ConstPtr& cloud,
                     const Eigen::Isometry3d& T_world_camera)
{
  if (superpixels_)
    superpixels_->setFrame(cloud, T_world_camera);
}

std::vector<pcl::PointIndices>
MapCliques::generate(const VoxelCloud& voxels)
{
  if (superpixels_)
    superpixels_->setVoxels(voxels.indices, voxels.voxel_size);
  CliqueGenerator::Cloud cloud;
  pcl::copyPointCloud(*voxels.cloud, cloud);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    cloud[i].getVector3fMap() = voxels.centre(i);
  std::vector<pcl::PointIndices> cliques = generator_->generate(cloud);
  if (left_out_.empty())
    return cliques;
  const auto is_out = [&](pcl::index_t i) {
    float likely = 0.0f;
    for (const Label label : left_out_)
      likely += voxels.measured.column(i)[label - 1];
    return likely > kExcludeThreshold;
  };
  for (pcl::PointIndices& clique : cliques) {
    pcl::Indices& members = clique.indices;
    members.erase(std::remove_if(members.begin(), members.end(), is_out),
                  members.end());
  }
  cliques.erase(
      std::remove_if(cliques.begin(), cliques.end(),
                     [](const auto& clique) { return clique.indices.empty(); }),
      cliques.end());
  return cliques;
}

} // namespace pcl_semantic
