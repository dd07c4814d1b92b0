// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/cliques/supervoxel_cliques.h>

#include "supervoxel_clustering.h"

#include "core/fail.h"
#include "core/parallel_guard.h"

#include <pcl_semantic/core/no_return.h>

#include <pcl/kdtree/kdtree_flann.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>
#include <vector>

namespace pcl_semantic {

namespace {

using Cloud = CliqueGenerator::Cloud;

constexpr int kSeedsACube = 8;

// Positions are rounded. Otherwise ties between the distances of a regular grid would
// depend on the last bits of its coordinates, that is on the position of the cloud.
constexpr int kStepsAVoxel = 256;

// Adds two points beyond opposite corners of the cube. PCL derives its voxel grid from
// the extent of the points, so these fix the grid to the corner of the cube, and map
// voxels are centred in PCL's voxels. They are too far away to touch another voxel and
// do not affect the result.
pcl::PointCloud<SupervoxelPoint>::Ptr
withCorners(const Cloud& cloud, double resolution, int voxels)
{
  const int depth = int(std::ceil(std::log2(voxels + 8)));
  const double half = 0.5 * resolution * ((1 << depth) - 1);
  const double middle = 0.5 * resolution * voxels;
  auto result = std::make_shared<pcl::PointCloud<SupervoxelPoint>>();
  pcl::copyPointCloud(cloud, *result);
  for (const double corner : {middle - half, middle + half}) {
    SupervoxelPoint point;
    point.getVector3fMap().setConstant(float(corner));
    result->push_back(point);
  }
  return result;
}

/** \brief Supervoxels of the points in a cube [0, edge)^3; edge is an even number of
 * voxels.
 * \param[in] cloud finite points of the cube [m]
 * \param[in] voxels edge of the cube in voxels
 * \return one label per point, 0 = none */
std::vector<std::uint32_t>
clusterSupervoxels(const Cloud& cloud, const SupervoxelParameters& parameters,
                   int voxels)
{
  // A new object each time: a reused one mixes its points with the earlier ones.
  const auto resolution = float(parameters.voxel_resolution);
  SupervoxelClustering clustering(resolution, float(parameters.seed_resolution));
  clustering.setUseSingleCameraTransform(false);
  clustering.setInputCloud(withCorners(cloud, double(resolution), voxels));
  std::map<std::uint32_t, pcl::Supervoxel<SupervoxelPoint>::Ptr> supervoxels;
  clustering.extract(supervoxels);
  const auto labelled = clustering.getLabeledCloud();
  std::vector<std::uint32_t> labels(cloud.size());
  for (std::size_t i = 0; i < labels.size(); ++i)
    labels[i] = (*labelled)[i].label;
  return labels;
}

/** \brief Labels the remaining points as the nearest labelled point within \a reach
 * [m]. */
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

// Even, so that the middle of a cube is a voxel boundary.
int
voxelsACube(const SupervoxelParameters& parameters)
{
  return 2 * int(std::ceil(0.5 * kSeedsACube * parameters.seed_resolution /
                               parameters.voxel_resolution -
                           1e-6));
}

void
require(bool holds, const char* name, double value, const char* expected)
{
  if (!holds)
    badParameter("supervoxels: ", name, " is ", value, ", expected ", expected);
}

template <typename Point>
auto
keyOf(const Point& point)
{
  return std::tie(point.z, point.y, point.x, point.rgb);
}

// A supervoxel: index of its cube and label in the cube, 0 = none.
struct Name {
  std::size_t cube = 0;
  std::uint32_t label = 0;
};

std::vector<pcl::PointIndices>
cliquesOf(const std::vector<Name>& names, std::size_t cubes)
{
  std::vector<std::vector<std::size_t>> numbers(cubes); // by label, from 1; 0 = unused
  std::vector<pcl::PointIndices> cliques;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& [cube, label] = names[i];
    if (label == 0)
      continue;
    if (numbers[cube].size() <= label)
      numbers[cube].resize(label + 1, 0);
    std::size_t& number = numbers[cube][label];
    if (number == 0) {
      cliques.emplace_back();
      number = cliques.size();
    }
    cliques[number - 1].indices.push_back(pcl::index_t(i));
  }
  return cliques;
}

} // namespace

void
SupervoxelParameters::validate() const
{
  require(voxel_resolution >= 1e-3 && voxel_resolution <= 1e3, "voxel resolution",
          voxel_resolution, "0.001 to 1000 m");
  require(seed_resolution >= 2.0 * voxel_resolution &&
              seed_resolution <= 100.0 * voxel_resolution,
          "seed resolution", seed_resolution, "2 to 100 voxel resolutions");
}

SupervoxelCliques::SupervoxelCliques(const SupervoxelParameters& parameters)
    : parameters_(parameters)
{
  parameters_.validate();
}

double
SupervoxelCliques::cubeEdge() const
{
  return voxelsACube(parameters_) * parameters_.voxel_resolution;
}

// Origin of the grid of cubes, in the cloud's coordinates. Positions on a grid then
// avoid voxel boundaries.
Eigen::Vector3d
SupervoxelCliques::cornerOf(const Cloud& cloud) const
{
  if (parameters_.fixed_cubes)
    return -origin_;
  const PlaceTest has_place(cloud);
  Eigen::Array3f lowest = Eigen::Array3f::Constant(std::numeric_limits<float>::max());
  const auto farthest = float(kMaxVoxelIndex * cubeEdge());
  for (const pcl::PointXYZRGB& point : cloud)
    if (has_place(point) && (point.getArray3fMap().abs() <= farthest).all())
      lowest = lowest.min(point.getArray3fMap());
  return lowest.cast<double>() - 0.5 * parameters_.voxel_resolution;
}

std::vector<SupervoxelCliques::Members>
SupervoxelCliques::groupByCube(const Cloud& cloud) const
{
  const double edge = cubeEdge();
  const double step = parameters_.voxel_resolution / kStepsAVoxel;
  const PlaceTest has_place(cloud);
  const Eigen::Vector3d corner = cornerOf(cloud);
  std::vector<Members> groups;
  std::unordered_map<VoxelIndex, std::size_t, VoxelIndexHash> numbers;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const pcl::PointXYZRGB& point = cloud[i];
    if (!has_place(point))
      continue;
    const Eigen::Vector3d place = point.getVector3fMap().cast<double>() - corner;
    const Eigen::Array3d cells = place / edge;
    if (!(cells.abs() <= kMaxVoxelIndex).all())
      badInput("point ", i, " lies at ", (place + corner + origin_).transpose(),
               " m, too far from the others or from the origin for supervoxels");
    const VoxelIndex cube = cells.floor().cast<int>();
    const auto [entry, is_new] = numbers.try_emplace(cube, groups.size());
    if (is_new)
      groups.push_back({cube, {}});
    const Eigen::Array3d position = place.array() - edge * cube.cast<double>().array();
    const Eigen::Array3f rounded = ((position / step).round() * step).cast<float>();
    groups[entry->second].points.push_back(
        {{rounded.x(), rounded.y(), rounded.z(), point.rgba & 0xFFFFFF},
         pcl::index_t(i)});
  }
  return groups;
}

std::vector<std::uint32_t>
SupervoxelCliques::cluster(const std::vector<Point>& points) const
{
  Cloud cloud;
  cloud.reserve(points.size() + 2);
  for (const Point& point : points) {
    pcl::PointXYZRGB copy;
    copy.getVector3fMap() = Eigen::Vector3f(point.x, point.y, point.z);
    copy.rgba = point.rgb;
    cloud.push_back(copy);
  }
  std::vector<std::uint32_t> labels =
      clusterSupervoxels(cloud, parameters_, voxelsACube(parameters_));
  labelTheRest(cloud, parameters_.seed_resolution, labels);
  return labels;
}

// Sorts the points and reuses the previous result if they are unchanged.
SupervoxelCliques::Cube
SupervoxelCliques::cubeOf(Members& members, char& changed) const
{
  const auto is_before = [](const auto& a, const auto& b) {
    return keyOf(a.first) < keyOf(b.first);
  };
  std::sort(members.points.begin(), members.points.end(), is_before);
  Cube cube;
  cube.points.reserve(members.points.size());
  for (const auto& [point, index] : members.points)
    cube.points.push_back(point);
  const auto last = cubes_.find(members.cube);
  changed =
      last == cubes_.end() ||
      !std::equal(cube.points.begin(), cube.points.end(), last->second.points.begin(),
                  last->second.points.end(),
                  [](const Point& a, const Point& b) { return keyOf(a) == keyOf(b); });
  cube.labels = changed ? cluster(cube.points) : last->second.labels;
  return cube;
}

std::vector<pcl::PointIndices>
SupervoxelCliques::generate(const Cloud& cloud)
{
  judgeSteps("SupervoxelCliques", cloud);
  std::vector<Members> groups = groupByCube(cloud);
  std::vector<Cube> cubes(groups.size());
  std::vector<char> changed(groups.size(), 0);
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t g = 0; g < groups.size(); ++g)
    guard.run([&] { cubes[g] = cubeOf(groups[g], changed[g]); });
  guard.rethrow();
  std::vector<Name> names(cloud.size());
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t m = 0; m < groups[g].points.size(); ++m)
      names[std::size_t(groups[g].points[m].second)] = {g, cubes[g].labels[m]};
  changed_cubes_ = std::size_t(std::count(changed.begin(), changed.end(), 1));
  cubes_.clear();
  for (std::size_t g = 0; g < groups.size(); ++g)
    cubes_.emplace(groups[g].cube, std::move(cubes[g]));
  return cliquesOf(names, groups.size());
}

} // namespace pcl_semantic
