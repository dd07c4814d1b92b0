// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/pipeline/frame_calibration.h>
#include <pcl_semantic/pipeline/listed_labels.h>
#include <pcl_semantic/pipeline/map_cliques.h>

#include <pcl/common/io.h>

#include <algorithm>

namespace pcl_semantic {

MapCliques::MapCliques(const MapperConfig& config, const LabelSet& label_set)
    : generator_(makeCliqueGenerator(config.cliques, config.clique_parameters)),
      superpixels_(std::dynamic_pointer_cast<SuperpixelCliques>(generator_)),
      left_out_(listedLabels(config.clique_leaves_out, label_set, "clique_leaves_out")),
      leaves_out_above_(float(config.clique_leaves_out_above)),
      classes_(label_set.size())
{}

void
MapCliques::setCalibration(LabelCalibration calibration)
{
  calibration.validate();
  if (calibration.classes() != classes_)
    PCL_THROW_EXCEPTION(InvalidParameterException, "clique calibration of "
                                                       << calibration.classes()
                                                       << " classes for a map of "
                                                       << classes_);
  ground_ = calibration.ground;
  calibration_ = std::move(calibration);
}

void
MapCliques::setFrame(const pcl::PointCloud<pcl::PointXYZRGB>::ConstPtr& cloud,
                     const LabelDistributions& network,
                     const Eigen::Isometry3d& T_world_camera)
{
  if (superpixels_)
    superpixels_->setFrame(cloud, T_world_camera);
  view_ = {T_world_camera, {}};
  if (!ground_.empty())
    view_.ground = frameGround(*cloud, network, ground_);
}

std::vector<pcl::PointIndices>
MapCliques::group(const VoxelCloud& voxels)
{
  if (superpixels_)
    superpixels_->setVoxels(voxels.indices, voxels.voxel_size);
  CliqueGenerator::Cloud cloud;
  pcl::copyPointCloud(*voxels.cloud, cloud);
  std::vector<pcl::PointIndices> cliques = generator_->generate(cloud);
  if (left_out_.empty())
    return cliques;
  const auto is_out = [&](pcl::index_t i) {
    float likely = 0.0f;
    for (const Label label : left_out_)
      likely += voxels.measured.column(i)[label - 1];
    return likely > leaves_out_above_;
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

MapCliques::Result
MapCliques::generate(const VoxelCloud& voxels)
{
  Result result{group(voxels), {}};
  if (!calibration_)
    return result;
  const CliqueEvidence known = evidence(voxels, result.cliques);
  constexpr float least = 1e-6f;
  result.costs = -calibrate(*calibration_, known.distributions, known.features)
                      .matrix()
                      .array()
                      .max(least)
                      .log();
  return result;
}

} // namespace pcl_semantic
