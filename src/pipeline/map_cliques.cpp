// SPDX-License-Identifier: BSD-3-Clause
#include "map_cliques.h"
#include "core/fail.h"
#include "core/parallel_guard.h"
#include "frame_calibration.h"
#include "stereo/cloud_features.h"

#include <pcl_semantic/labelling/label_calibration.h>

#include <Eigen/Eigenvalues>
#include <pcl/common/io.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

// Voxels with a higher probability of the classes in clique_exclude join no clique
// (doc/calibration.md).
constexpr float kExcludeThreshold = 0.3f;

// Zero if no member has a measurement.
Eigen::VectorXd
geometricMean(const LabelDistributions& measured, const pcl::Indices& members)
{
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(measured.classes());
  int count = 0;
  for (const pcl::index_t i : members) {
    const auto column = measured.matrix().col(i).cast<double>().array();
    const double total = column.sum();
    if (!(total > 0.0))
      continue;
    sum += (column / total).max(double(kMinProbability)).log();
    ++count;
  }
  if (count == 0)
    return Eigen::VectorXd::Zero(measured.classes());
  sum = (sum / count - sum.maxCoeff() / count).exp();
  return (sum / sum.sum()).matrix();
}

// |cosine| between a direction and the normal of the members' best plane.
float
levelOf(const Eigen::Matrix3Xd& positions, double voxel_size, const Eigen::Vector3d& up)
{
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  if (positions.cols() < 3)
    return unknown;
  const Eigen::Matrix3Xd centred = positions.colwise() - positions.rowwise().mean();
  const Eigen::Matrix3d scatter =
      centred * centred.transpose() / double(positions.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const double across = 0.25 * voxel_size; // narrower sets are lines
  if (solver.eigenvalues()[1] < across * across)
    return unknown;
  return float(std::abs(solver.eigenvectors().col(0).dot(up)));
}

void
addGeometry(const VoxelCloud& voxels, const pcl::Indices& members,
            const GroundView& view, PointFeatures& features)
{
  const Eigen::Isometry3d T_camera_world = view.T_world_camera.inverse();
  Eigen::Matrix3Xd positions(3, Eigen::Index(members.size())); // camera frame
  for (std::size_t k = 0; k < members.size(); ++k)
    positions.col(Eigen::Index(k)) =
        T_camera_world * ((voxels.indices[std::size_t(members[k])].cast<double>() +
                           Eigen::Vector3d::Constant(0.5).matrix()) *
                          voxels.voxel_size);
  const Eigen::Vector3d mean = positions.rowwise().mean();
  const Eigen::Vector3d up = view.ground->normal();
  const double offset = view.ground->offset();
  const Eigen::RowVectorXd heights = up.transpose() * positions;
  features[Feature::height] = float(up.dot(mean) + offset);
  features[Feature::distance] = float(mean.z());
  features[Feature::level] = levelOf(positions, voxels.voxel_size, up);
  features[Feature::side] = float(std::abs(rightAlong(*view.ground).dot(mean)));
  features[Feature::lowest] = float(heights.minCoeff() + offset);
  features[Feature::extent] = float(heights.maxCoeff() - heights.minCoeff());
}

void
addColour(const VoxelCloud& voxels, const pcl::Indices& members,
          PointFeatures& features)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const pcl::index_t i : members)
    sum += (*voxels.cloud)[std::size_t(i)].getRGBVector3i().cast<double>();
  const Eigen::Vector3f mean = (sum / double(members.size())).cast<float>();
  features.setColour(mean.x(), mean.y(), mean.z());
}

} // namespace

CliqueEvidence
cliqueEvidence(const VoxelCloud& voxels, const std::vector<pcl::PointIndices>& cliques,
               const GroundView& view)
{
  CliqueEvidence evidence;
  evidence.distributions =
      LabelDistributions(voxels.measured.classes(), Eigen::Index(cliques.size()));
  evidence.features.resize(cliques.size());
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 8)
  for (std::size_t c = 0; c < cliques.size(); ++c)
    guard.run([&] {
      evidence.distributions.matrix().col(Eigen::Index(c)) =
          geometricMean(voxels.measured, cliques[c].indices).cast<float>();
      addColour(voxels, cliques[c].indices, evidence.features[c]);
      if (view.ground)
        addGeometry(voxels, cliques[c].indices, view, evidence.features[c]);
    });
  guard.rethrow();
  return evidence;
}

MapCliques::MapCliques(const MapperConfig& config, const LabelSet& label_set)
    : generator_(makeCliqueGenerator(config.cliques, config.clique_parameters)),
      superpixels_(std::dynamic_pointer_cast<SuperpixelCliques>(generator_)),
      left_out_(listedLabels(config.clique_exclude, label_set, "clique_exclude")),
      classes_(label_set.size())
{
  generator_->setOrigin(Eigen::Vector3d::Zero());
}

void
MapCliques::setCalibration(LabelCalibration calibration)
{
  calibration.validate();
  if (calibration.classes() != classes_)
    badParameter("clique calibration of ", calibration.classes(),
                 " classes for a map of ", classes_);
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
