// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/evaluation/map_geometry.h>

#include "core/fail.h"
#include "core/parallel_guard.h"
#include "files/report_text.h"

#include <pcl_semantic/core/visible_points.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <pcl/kdtree/kdtree_flann.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pcl_semantic {

namespace {

std::vector<double>
checkedBands(const std::vector<double>& bands)
{
  if (bands.size() < 2 || !(bands.front() >= 0.0) ||
      std::adjacent_find(bands.begin(), bands.end(),
                         [](double a, double b) { return !(b > a); }) != bands.end())
    badParameter("borders of the bands have to grow from 0 or more");
  return bands;
}

// Camera z of the farthest return of each pixel; 0 = none.
cv::Mat1f
farthestDepths(const std::vector<Eigen::Vector3d>& camera_points,
               const StereoCamera& camera)
{
  cv::Mat1f depths(camera.height, camera.width, 0.0f);
  for (const Eigen::Vector3d& point : camera_points)
    if (const auto pixel = pixelOf(point, camera)) {
      float& depth = depths(pixel->y(), pixel->x());
      depth = std::max(depth, static_cast<float>(point.z()));
    }
  return depths;
}

// The farthest return around a pixel; 0 if they are not on both sides of its row.
float
depthBehind(const cv::Mat1f& depths, const Eigen::Vector2i& pixel,
            const GeometryParameters& parameters)
{
  bool above = false, below = false;
  float farthest = 0.0f;
  const int first_row = std::max(pixel.y() - parameters.window_rows, 0);
  const int last_row = std::min(pixel.y() + parameters.window_rows, depths.rows - 1);
  const int first_column = std::max(pixel.x() - parameters.window_columns, 0);
  const int last_column =
      std::min(pixel.x() + parameters.window_columns, depths.cols - 1);
  for (int v = first_row; v <= last_row; ++v)
    for (int u = first_column; u <= last_column; ++u)
      if (depths(v, u) > 0.0f) {
        farthest = std::max(farthest, depths(v, u));
        above = above || v <= pixel.y();
        below = below || v >= pixel.y();
      }
  return above && below ? farthest : 0.0f;
}

} // namespace

GeometrySamples&
GeometrySamples::operator+=(const GeometrySamples& other)
{
  voxels += other.voxels;
  distances.insert(distances.end(), other.distances.begin(), other.distances.end());
  surface.resize(std::max(surface.size(), other.surface.size()));
  for (std::size_t i = 0; i < other.surface.size(); ++i) {
    surface[i].points += other.surface[i].points;
    surface[i].at += other.surface[i].at;
    surface[i].adjacent += other.surface[i].adjacent;
    surface[i].within += other.surface[i].within;
  }
  return *this;
}

MapGeometry::MapGeometry(const VoxelCloud& voxels, GeometryParameters parameters)
    : parameters_(std::move(parameters)), lookup_(voxels), judged_(voxels.size(), 0),
      surface_(checkedBands(parameters_.bands).size() - 1)
{
  for (const auto& point : *voxels.cloud)
    positions_.push_back(point.getVector3fMap().cast<double>() + voxels.origin);
}

void
MapGeometry::addScan(const pcl::PointCloud<pcl::PointXYZI>& scan,
                     const StereoCamera& camera,
                     const Eigen::Isometry3d& T_world_camera,
                     const Eigen::Isometry3d& T_camera_scanner)
{
  if (returns_->empty())
    origin_ = T_world_camera.translation();
  VisibilityParameters seen_parameters;
  seen_parameters.max_depth = parameters_.bands.back();
  const std::vector<Eigen::Vector3d> camera_points =
      pointsInCamera(scan, T_camera_scanner);
  const std::vector<SeenPoint> seen =
      seenPoints(camera_points, camera, seen_parameters);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3d point = T_world_camera * camera_points[i];
    addReturn(point);
    if (seen[i].depth > 0.0f)
      countSurface(point, seen[i].depth);
  }
  judgeVoxels(camera_points, camera, T_world_camera.inverse());
}

void
MapGeometry::addScan(const std::vector<Eigen::Vector3d>& points,
                     const Eigen::Isometry3d& T_world_scanner)
{
  if (returns_->empty())
    origin_ = T_world_scanner.translation();
  for (const Eigen::Vector3d& in_scan : points)
    if (in_scan.allFinite()) {
      addReturn(T_world_scanner * in_scan);
      countSurface(T_world_scanner * in_scan, float(in_scan.norm()));
    }
  const Eigen::Vector3d scanner = T_world_scanner.translation();
  for (std::size_t i = 0; i < judged_.size(); ++i)
    judged_[i] |= (positions_[i] - scanner).norm() <= parameters_.bands.back();
}

void
MapGeometry::addReturn(const Eigen::Vector3d& point)
{
  const Eigen::Vector3f near = (point - origin_).cast<float>();
  returns_->push_back(pcl::PointXYZ(near.x(), near.y(), near.z()));
}

void
MapGeometry::judgeVoxels(const std::vector<Eigen::Vector3d>& camera_points,
                         const StereoCamera& camera,
                         const Eigen::Isometry3d& T_camera_world)
{
  const cv::Mat1f depths = farthestDepths(camera_points, camera);
#pragma omp parallel for schedule(dynamic, 1024)
  for (std::size_t i = 0; i < judged_.size(); ++i) {
    const Eigen::Vector3d position = T_camera_world * positions_[i];
    const auto pixel = pixelOf(position, camera);
    if (judged_[i] || !pixel || position.z() > parameters_.bands.back())
      continue;
    const float behind = depthBehind(depths, *pixel, parameters_);
    judged_[i] = behind > 0.0f && position.z() <= behind + parameters_.behind;
  }
}

void
MapGeometry::countSurface(const Eigen::Vector3d& point, float depth)
{
  const std::vector<double>& bands = parameters_.bands;
  const auto after = std::upper_bound(bands.begin(), bands.end(), double(depth));
  if (after == bands.begin() || after == bands.end())
    return;
  SurfaceCounts& counts = surface_[std::size_t(after - bands.begin()) - 1];
  ++counts.points;
  const bool at = lookup_.at(point) != VoxelLookup::none;
  bool adjacent = at;
  for (int i = 0; i < 27 && !adjacent; ++i)
    adjacent = lookup_.at(point + lookup_.voxelSize() *
                                      Eigen::Vector3d(i % 3 - 1, i / 3 % 3 - 1,
                                                      i / 9 - 1)) != VoxelLookup::none;
  counts.at += at;
  counts.adjacent += adjacent;
  counts.within += lookup_.nearest(point, parameters_.within) != VoxelLookup::none;
}

GeometrySamples
MapGeometry::samples() const
{
  GeometrySamples result;
  result.voxels = positions_.size();
  result.surface = surface_;
  if (returns_->empty())
    return result;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree;
  tree.setInputCloud(returns_);
  std::vector<float> squared(positions_.size(), 0.0f);
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 256)
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (!judged_[i])
      continue;
    guard.run([&] {
      const Eigen::Vector3f position = (positions_[i] - origin_).cast<float>();
      pcl::Indices nearest(1);
      std::vector<float> distance(1);
      tree.nearestKSearch(pcl::PointXYZ(position.x(), position.y(), position.z()), 1,
                          nearest, distance);
      squared[i] = distance[0];
    });
  }
  guard.rethrow();
  for (std::size_t i = 0; i < squared.size(); ++i)
    if (judged_[i])
      result.distances.push_back(std::sqrt(squared[i]));
  return result;
}

GeometryScores
scoreGeometry(const GeometrySamples& samples)
{
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  GeometryScores scores;
  scores.voxels = samples.voxels;
  scores.judged = samples.distances.size();
  if (scores.judged == 0) {
    scores.mean = scores.median = scores.percentile_90 = none;
    scores.fractions.fill(none);
    return scores;
  }
  std::vector<float> sorted = samples.distances;
  std::sort(sorted.begin(), sorted.end());
  const double count = double(sorted.size());
  const auto quantile = [&](double fraction) {
    return double(sorted[std::size_t(fraction * (count - 1.0) + 0.5)]);
  };
  scores.mean = std::accumulate(sorted.begin(), sorted.end(), 0.0) / count;
  scores.median = quantile(0.5);
  scores.percentile_90 = quantile(0.9);
  for (std::size_t i = 0; i < scores.fractions.size(); ++i)
    scores.fractions[i] = double(std::upper_bound(sorted.begin(), sorted.end(),
                                                  float(GeometryScores::limits[i])) -
                                 sorted.begin()) /
                          count;
  return scores;
}

namespace {

// A number with so many decimals; "-" if there is none.
std::string
rounded(double value, int decimals)
{
  return std::isfinite(value) ? cv::format("%.*f", decimals, value) : "-";
}

std::string
bandName(const GeometryParameters& parameters, std::size_t band)
{
  return cv::format("%g-%g m", parameters.bands[band], parameters.bands[band + 1]);
}

double
fraction(std::uint64_t part, std::uint64_t whole)
{
  return double(part) / double(whole); // 0 / 0 is NaN
}

// Fractions in a voxel, next to one, and near one [%].
std::string
fractionsOf(const SurfaceCounts& band)
{
  return rounded(100.0 * fraction(band.at, band.points), 1) + " / " +
         rounded(100.0 * fraction(band.adjacent, band.points), 1) + " / " +
         rounded(100.0 * fraction(band.within, band.points), 1);
}

} // namespace

std::string
geometryTable(const GeometrySamples& samples, const GeometryParameters& parameters)
{
  const GeometryScores scores = scoreGeometry(samples);
  std::string text = "voxels " + std::to_string(scores.voxels) + ", judged " +
                     std::to_string(scores.judged) +
                     "\n\nfrom a voxel to the nearest return\n  mean      " +
                     rounded(scores.mean, 3) + " m\n  median    " +
                     rounded(scores.median, 3) + " m\n  90 %      " +
                     rounded(scores.percentile_90, 3) + " m\n";
  for (std::size_t i = 0; i < scores.fractions.size(); ++i)
    text += "  to " + rounded(GeometryScores::limits[i], 1) + " m  " +
            rounded(100.0 * scores.fractions[i], 1) + " %\n";
  text += "\nreturns in a voxel / next to one / within " +
          cv::format("%g", parameters.within) + " m of one\n";
  for (std::size_t i = 0; i < samples.surface.size(); ++i)
    text += "  " + bandName(parameters, i) + ": " + fractionsOf(samples.surface[i]) +
            " % of " + std::to_string(samples.surface[i].points) + "\n";
  return text;
}

std::string
geometryMarkdownHeader(const GeometryParameters& parameters)
{
  std::string titles = "| | mean cm | median cm | 90 % cm |",
              rule = "|---|---:|---:|---:|";
  for (const double limit : GeometryScores::limits) {
    titles += " to " + rounded(100.0 * limit, 0) + " cm % |";
    rule += "---:|";
  }
  for (std::size_t i = 0; i + 1 < parameters.bands.size(); ++i) {
    titles += " mapped " + bandName(parameters, i) + " % |";
    rule += "---:|";
  }
  return titles + "\n" + rule + "\n";
}

std::string
geometryMarkdownRow(const GeometrySamples& samples,
                    const GeometryParameters& parameters, const std::string& name)
{
  const GeometryScores scores = scoreGeometry(samples);
  std::string text = "| " + name + " |";
  for (const double distance : {scores.mean, scores.median, scores.percentile_90})
    text += " " + rounded(100.0 * distance, 1) + " |";
  for (const double part : scores.fractions)
    text += " " + rounded(100.0 * part, 1) + " |";
  std::vector<SurfaceCounts> surface = samples.surface;
  surface.resize(parameters.bands.size() - 1);
  for (const SurfaceCounts& band : surface)
    text += " " + fractionsOf(band) + " |";
  return text + "\n";
}

std::string
geometryJson(const GeometrySamples& samples, const GeometryParameters& parameters)
{
  const GeometryScores scores = scoreGeometry(samples);
  nlohmann::ordered_json json; // NaN becomes null
  json["voxels"] = scores.voxels;
  json["judged"] = scores.judged;
  json["distance"] = {
      {"mean", scores.mean}, {"median", scores.median}, {"90 %", scores.percentile_90}};
  for (std::size_t i = 0; i < scores.fractions.size(); ++i)
    json["within"][rounded(GeometryScores::limits[i], 1)] = scores.fractions[i];
  json["surface"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < samples.surface.size(); ++i) {
    const SurfaceCounts& band = samples.surface[i];
    json["surface"].push_back({{"from", parameters.bands[i]},
                               {"to", parameters.bands[i + 1]},
                               {"points", band.points},
                               {"in_voxel", fraction(band.at, band.points)},
                               {"next_to_voxel", fraction(band.adjacent, band.points)},
                               {"within", fraction(band.within, band.points)}});
  }
  return jsonText(json);
}

} // namespace pcl_semantic
