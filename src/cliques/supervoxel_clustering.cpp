// SPDX-License-Identifier: BSD-3-Clause
#include "supervoxel_clustering.h"

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/segmentation/supervoxel_clustering.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace pcl_semantic {

namespace {

using Cloud = CliqueGenerator::Cloud;

// Two points beyond opposite corners of the cube. PCL lays its voxels by the extent of
// the points: with these it is always the same, and the voxels of the cube are those
// that begin at its corner, so that voxels of a map fall into the middle of PCL's. They
// are too far off to touch another voxel, and take no part in the result.
Cloud
withCorners(const Cloud& cloud, double resolution, int voxels)
{
  const int depth = int(std::ceil(std::log2(voxels + 8)));
  const double half = 0.5 * resolution * ((1 << depth) - 1);
  const double middle = 0.5 * resolution * voxels;
  Cloud result = cloud;
  for (const double corner : {middle - half, middle + half}) {
    pcl::PointXYZRGB point;
    point.x = point.y = point.z = float(corner);
    result.push_back(point);
  }
  return result;
}

} // namespace

std::vector<std::uint32_t>
clusterSupervoxels(const Cloud& cloud, const SupervoxelParameters& parameters,
                   int voxels)
{
  // A new object each time: used again it mixes its points with the earlier ones.
  const auto resolution = float(parameters.voxel_resolution);
  pcl::SupervoxelClustering<pcl::PointXYZRGB> clustering(
      resolution, float(parameters.seed_resolution));
  clustering.setUseSingleCameraTransform(false);
  clustering.setColorImportance(float(parameters.colour_weight));
  clustering.setSpatialImportance(float(parameters.spatial_weight));
  clustering.setNormalImportance(float(parameters.normal_weight));
  const auto input =
      std::make_shared<Cloud>(withCorners(cloud, double(resolution), voxels));
  clustering.setInputCloud(input);
  std::map<std::uint32_t, pcl::Supervoxel<pcl::PointXYZRGB>::Ptr> supervoxels;
  clustering.extract(supervoxels);
  const auto labelled = clustering.getLabeledCloud();
  std::vector<std::uint32_t> labels(cloud.size());
  for (std::size_t i = 0; i < labels.size(); ++i)
    labels[i] = (*labelled)[i].label;
  return labels;
}

void
labelTheRest(const Cloud& cloud, double reach, std::vector<std::uint32_t>& labels)
{
  const auto has_label = [](std::uint32_t label) { return label != 0; };
  const auto labelled = std::count_if(labels.begin(), labels.end(), has_label);
  if (labelled == 0 || std::size_t(labelled) == labels.size())
    return;
  const auto known = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
  std::vector<std::uint32_t> known_labels;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (has_label(labels[i])) {
      known->push_back({cloud[i].x, cloud[i].y, cloud[i].z});
      known_labels.push_back(labels[i]);
    }
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(known);
  pcl::Indices nearest(1);
  std::vector<float> distances(1);
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (!has_label(labels[i]) &&
        tree.nearestKSearch(pcl::PointXYZ(cloud[i].x, cloud[i].y, cloud[i].z), 1,
                            nearest, distances) == 1 &&
        double(distances[0]) <= reach * reach)
      labels[i] = known_labels[std::size_t(nearest[0])];
}

} // namespace pcl_semantic
