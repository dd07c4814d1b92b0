// SPDX-License-Identifier: BSD-3-Clause
#include "map_cliques.h"

#include <pcl_semantic/cliques/ranked_cliques.h>

#include <pcl/common/io.h>

namespace pcl_semantic {

MapCliques::MapCliques(const MapperConfig& config)
    : generator_(makeCliqueGenerator(config.cliques, config.clique_parameters))
{
  for (const CliqueGenerator::Ptr& each : generatorsOf(generator_))
    if (auto superpixels = std::dynamic_pointer_cast<SuperpixelCliques>(each))
      superpixels_.push_back(superpixels);
}

void
MapCliques::setFrame(const pcl::PointCloud<pcl::PointXYZRGB>::ConstPtr& cloud,
                     const Eigen::Isometry3d& T_world_camera)
{
  for (const auto& superpixels : superpixels_)
    superpixels->setFrame(cloud, T_world_camera);
}

std::vector<pcl::PointIndices>
MapCliques::generate(const VoxelCloud& voxels)
{
  for (const auto& superpixels : superpixels_)
    superpixels->setVoxels(voxels.indices, voxels.voxel_size);
  const auto means = std::make_shared<CliqueGenerator::Cloud>();
  pcl::copyPointCloud(*voxels.cloud, *means);
  generator_->setMeanPositions(means, voxels.voxel_size);
  generator_->setOrigin(voxels.origin);
  CliqueGenerator::Cloud cloud = *means;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    cloud[i].getVector3fMap() = voxels.centre(i);
  return generator_->generate(cloud);
}

} // namespace pcl_semantic
