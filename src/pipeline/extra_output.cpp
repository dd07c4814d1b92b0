// SPDX-License-Identifier: BSD-3-Clause
#include "extra_output.h"

#include "core/fail.h"
#include "files/is_there.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/measured_depth.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/labelling/visible_points.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace pcl_semantic {

namespace {

// Requirements of a folder: options, or a camera.
namespace need {
constexpr unsigned measured = 1, depth = 2, probabilities = 4, scans = 8;
constexpr unsigned within = 16, camera = 32;
} // namespace need

// Folders "final_..." are written for the finished map, the others at each frame.
struct Folder {
  const char* name;
  unsigned needs;
};

constexpr Folder folders[] = {
    {"measured_labels", need::camera | need::measured},
    {"measured_labels_at_depth", need::camera | need::measured},
    {"depth", need::camera | need::depth},
    {"probabilities_at_depth", need::camera | need::probabilities},
    {"scan_labels", need::scans},
    {"measured_scan_labels", need::scans | need::measured},
    {"network_scan_labels", need::scans},
    {"near_scan_labels", need::scans | need::within},
    {"measured_near_scan_labels", need::scans | need::within | need::measured},
    {"final_measured_labels", need::camera | need::measured},
    {"final_labels_at_depth", need::camera | need::depth},
    {"final_measured_labels_at_depth", need::camera | need::depth | need::measured},
    {"final_scan_labels", need::scans},
    {"final_measured_scan_labels", need::scans | need::measured},
    {"final_near_scan_labels", need::scans | need::within},
    {"final_measured_near_scan_labels", need::scans | need::within | need::measured}};

unsigned
needsMet(const ExtraOptions& options, bool has_camera)
{
  return (options.measured ? need::measured : 0u) | (options.depth ? need::depth : 0u) |
         (options.probabilities ? need::probabilities : 0u) |
         (options.scan ? need::scans : 0u) |
         (options.within > 0.0 ? need::within : 0u) | (has_camera ? need::camera : 0u);
}

cv::Mat
depthOf(const pcl::PointCloud<pcl::PointXYZRGB>& cloud)
{
  cv::Mat1f depth(int(cloud.height), int(cloud.width), 0.0f);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud[i].z > 0.0f) // false for NaN
      depth.at<float>(int(i / cloud.width), int(i % cloud.width)) = cloud[i].z;
  return depth;
}

pcl::PointCloud<pcl::PointXYZRGB>
cloudOf(const cv::Mat1f& depth, const StereoCamera& camera)
{
  pcl::PointCloud<pcl::PointXYZRGB> cloud(std::uint32_t(depth.cols),
                                          std::uint32_t(depth.rows));
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const float z = depth(v, u);
      cloud(u, v).getVector3fMap() =
          isMeasuredDepth(z)
              ? Eigen::Vector3f(camera.unproject(u, v, double(z)).cast<float>())
              : Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
    }
  return cloud;
}

} // namespace

ExtraOutput::ExtraOutput(const std::string& folder,
                         const std::optional<StereoCamera>& camera, double max_depth,
                         ExtraOptions options)
    : folder_(folder), camera_(camera), max_depth_(max_depth),
      options_(std::move(options))
{
  const unsigned met = needsMet(options_, camera_.has_value());
  for (const Folder& each : folders)
    if ((each.needs & ~met) == 0)
      makeOutputFolder((std::filesystem::path(folder_) / each.name).string());
}

void
ExtraOutput::requireFrame(int frame) const
{
  if (const std::string depth = path("depth", frame, ".png");
      options_.depth && !isThere(depth))
    badInput(depth, ": is missing; resume with the --output of the interrupted run");
}

const std::vector<std::string>&
ExtraOutput::names()
{
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Folder& folder : folders)
      all.push_back(folder.name);
    return all;
  }();
  return names;
}

void
ExtraOutput::removeEarlier(const std::string& folder, const std::vector<int>& kept)
{
  const auto isGone = [&](int frame) {
    return !std::binary_search(kept.begin(), kept.end(), frame);
  };
  std::error_code error;
  for (const std::string& name : names()) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    if (!std::filesystem::is_directory(path, error))
      continue;
    const bool is_final = name.rfind("final_", 0) == 0;
    for (const char* extension : {".png", ".label", ".npy"})
      removeFrameFiles(path, extension, is_final ? std::function<bool(int)>() : isGone);
  }
}

std::string
ExtraOutput::path(const std::string& name, int frame, const char* extension) const
{
  return (std::filesystem::path(folder_) / name / frameFileName(frame, extension))
      .string();
}

void
ExtraOutput::writeFrame(const MappedFrame& mapped) const
{
  const int frame = mapped.frame.number;
  if (options_.depth)
    writeDepthImage(path("depth", frame, ".png"), depthOf(*mapped.cloud));
  if (!options_.measured && !options_.probabilities && !options_.scan)
    return;
  const MapLabels labels(mapped.voxels);
  if (options_.measured && camera_) {
    writeMeasured("measured_labels", frame, mapped.voxels, labels.measured,
                  mapped.T_world_camera);
    writePng(path("measured_labels_at_depth", frame, ".png"),
             labelsAt(indicesAtDepth(*mapped.cloud, mapped.T_world_camera, labels),
                      labels.measured));
  }
  if (options_.probabilities)
    writeProbabilities(mapped, labels);
  if (!options_.scan)
    return;
  const std::vector<Eigen::Vector3d> points = options_.scan(frame);
  writeScan(frame, points, mapped.T_world_camera, labels, "");
  writeNetworkScan(mapped, points);
}

void
ExtraOutput::writeFinal(int frame, const Eigen::Isometry3d& T_world_camera,
                        const VoxelCloud& voxels, const MapLabels& labels) const
{
  if (options_.measured && camera_)
    writeMeasured("final_measured_labels", frame, voxels, labels.measured,
                  T_world_camera);
  if (options_.depth)
    writeFinalAtDepth(frame, T_world_camera, labels);
  if (options_.scan)
    writeScan(frame, options_.scan(frame), T_world_camera, labels, "final_");
}

void
ExtraOutput::writeMeasured(const std::string& name, int frame, const VoxelCloud& voxels,
                           const std::vector<Label>& measured,
                           const Eigen::Isometry3d& T_world_camera) const
{
  VoxelCloud labelled; // without distributions, which are large
  labelled.cloud = voxels.cloud->makeShared();
  labelled.indices = voxels.indices;
  labelled.observations = voxels.observations;
  labelled.voxel_size = voxels.voxel_size;
  labelled.origin = voxels.origin;
  for (std::size_t i = 0; i < measured.size(); ++i)
    (*labelled.cloud)[i].label = measured[i];
  writePng(path(name, frame, ".png"),
           renderLabels(labelled, *camera_, T_world_camera, max_depth_).labels);
}

void
ExtraOutput::writeScan(int frame, std::vector<Eigen::Vector3d> points,
                       const Eigen::Isometry3d& T_world_camera, const MapLabels& labels,
                       const std::string& prefix) const
{
  for (Eigen::Vector3d& point : points)
    point = T_world_camera * point;
  writePoints(frame, labels.lookup.indices(points), labels, prefix, "scan_labels");
  if (options_.within > 0.0)
    writePoints(frame, labels.lookup.indices(points, options_.within), labels, prefix,
                "near_scan_labels");
}

void
ExtraOutput::writePoints(int frame, const std::vector<std::int32_t>& indices,
                         const MapLabels& labels, const std::string& prefix,
                         const std::string& name) const
{
  std::vector<std::uint32_t> objects;
  if (!labels.objects.empty())
    for (const std::int32_t index : indices)
      objects.push_back(
          index == VoxelLookup::none ? 0 : labels.objects[std::size_t(index)]);
  writeScanLabels(path(prefix + name, frame, ".label"),
                  labelsAt(indices, labels.refined), objects);
  if (options_.measured)
    writeScanLabels(path(prefix + "measured_" + name, frame, ".label"),
                    labelsAt(indices, labels.measured));
}

// Like labelsAtDepth(), for the map in its exported form.
cv::Mat
ExtraOutput::indicesAtDepth(const pcl::PointCloud<pcl::PointXYZRGB>& cloud,
                            const Eigen::Isometry3d& T_world_camera,
                            const MapLabels& labels) const
{
  cv::Mat indices(int(cloud.height), int(cloud.width), CV_32SC1,
                  cv::Scalar(VoxelLookup::none));
  auto* const index = indices.ptr<std::int32_t>();
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud[i].z <= max_depth_) // false for NaN
      index[i] =
          labels.lookup.at(T_world_camera * cloud[i].getVector3fMap().cast<double>());
  return indices;
}

void
ExtraOutput::writeFinalAtDepth(int frame, const Eigen::Isometry3d& T_world_camera,
                               const MapLabels& labels) const
{
  const cv::Mat1f depth = readDepths(path("depth", frame, ".png"));
  const cv::Mat indices =
      indicesAtDepth(cloudOf(depth, *camera_), T_world_camera, labels);
  writePng(path("final_labels_at_depth", frame, ".png"),
           labelsAt(indices, labels.refined));
  if (options_.measured)
    writePng(path("final_measured_labels_at_depth", frame, ".png"),
             labelsAt(indices, labels.measured));
}

void
ExtraOutput::writeProbabilities(const MappedFrame& mapped,
                                const MapLabels& labels) const
{
  const cv::Mat indices = indicesAtDepth(*mapped.cloud, mapped.T_world_camera, labels);
  const LabelDistributions& refined = mapped.voxels.refined;
  LabelDistributions pixels(refined.classes(), Eigen::Index(indices.total()));
  for (Eigen::Index i = 0; i < pixels.size(); ++i)
    if (const auto index = indices.ptr<std::int32_t>()[i]; index >= 0)
      pixels.matrix().col(i) = refined.matrix().col(index);
  writeDistributions(path("probabilities_at_depth", mapped.frame.number, ".npy"),
                     pixels, indices.cols, NpyType::float16);
}

void
ExtraOutput::writeNetworkScan(const MappedFrame& mapped,
                              const std::vector<Eigen::Vector3d>& points) const
{
  std::vector<Label> labels(points.size(), kUnlabelled);
  for (std::size_t i = 0; i < labels.size() && !mapped.network.empty(); ++i)
    if (!camera_ && Eigen::Index(i) < mapped.network.size())
      labels[i] = mapped.network.mapLabel(Eigen::Index(i));
    else if (!camera_)
      break;
    else if (const auto pixel = pixelOf(points[i], *camera_))
      labels[i] = mapped.network.mapLabel(Eigen::Index(pixel->y()) * camera_->width +
                                          pixel->x());
  writeScanLabels(path("network_scan_labels", mapped.frame.number, ".label"), labels);
}

} // namespace pcl_semantic
