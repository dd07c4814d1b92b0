// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/mapping_output.h>

#include "core/fail.h"
#include "extra_output.h"
#include "files/folder_lock.h"
#include "files/is_there.h"
#include "files/report_text.h"
#include "run_folder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/input_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/object_file.h>
#include <pcl_semantic/files/plane_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/io/voxel_cloud_file.h>
#include <pcl_semantic/pictures/map_images.h>
#include <pcl_semantic/version.h>

#include <nlohmann/json.hpp>
#include <opencv2/core/version.hpp>
#include <pcl/pcl_config.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace pcl_semantic {

namespace {

using Json = nlohmann::ordered_json;

// Quantile of the values.
double
quantile(std::vector<double> values, double fraction)
{
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(fraction * double(values.size() - 1) + 0.5)];
}

cv::Mat
networkLabels(const MappedFrame& mapped)
{
  cv::Mat labels = cv::Mat::zeros(mapped.image.size(), CV_8UC1);
  for (Eigen::Index i = 0; i < mapped.network.size(); ++i)
    labels.data[i] = mapped.network.mapLabel(i);
  return labels;
}

Json
toJson(const Eigen::Vector3d& vector)
{
  return {vector.x(), vector.y(), vector.z()};
}

Json
versions()
{
  return {{"pcl_semantic", PCL_SEMANTIC_VERSION},
          {"pcl", PCL_VERSION_PRETTY},
          {"opencv", CV_VERSION}};
}

const ExtraOptions&
checked(const ExtraOptions& extra)
{
  if (!extra.images && (extra.measured || extra.depth || extra.probabilities))
    badParameter("measured labels, depth and probabilities need the images of the "
                 "frames");
  return extra;
}

} // namespace

MappingOutput::MappingOutput(const std::string& folder, const MappingRun& run,
                             std::vector<FrameRecord> records, ExtraOptions extra)
    : folder_(folder), run_(run), frames_(std::move(records)),
      has_images_(run.camera && checked(extra).images), centres_(extra.centres),
      extra_(std::make_unique<ExtraOutput>(folder, run.camera, run.config.map.max_range,
                                           std::move(extra)))
{
  requireImages();
  refuseForeignImages();
  RunFolder::requireRoom(folder_);
  makeOutputFolder(folder_);
  lock_ = std::make_unique<FolderLock>(folder_);
  if (!has_images_)
    return;
  for (const char* name : RunFolder::frame_folders)
    makeOutputFolder(path(name));
  makeOutputFolder(path("final_labels"));
}

MappingOutput::~MappingOutput() = default;

const std::vector<std::string>&
MappingOutput::names()
{
  return RunFolder::names();
}

// Images of a user must not be mixed with the output, nor removed with it.
void
MappingOutput::refuseForeignImages() const
{
  if (RunFolder::isSummary(path("summary.json")))
    return;
  std::error_code error;
  for (const std::string& name : names())
    if (std::filesystem::is_directory(path(name), error) &&
        !listFrameFiles(path(name), {".png", ".label"}).empty())
      fail<OutputException>(path(name), ": holds images without a summary.json beside "
                                        "it, expected a map; choose another folder");
}

// Frames of two runs must not share a folder: an unfinished summary marks it until the
// map is complete.
void
MappingOutput::replaceEarlierRun()
{
  if (replaced_)
    return;
  std::vector<int> kept;
  if (has_images_ || !run_.camera)
    for (const FrameRecord& frame : frames_)
      kept.push_back(frame.number);
  std::sort(kept.begin(), kept.end());
  RunFolder::beginRun(folder_, kept, has_images_);
  replaced_ = true;
}

std::string
MappingOutput::path(const std::string& name) const
{
  return (std::filesystem::path(folder_) / name).string();
}

void
MappingOutput::requireImages() const
{
  if (!has_images_)
    return;
  for (const FrameRecord& frame : frames_) {
    extra_->requireFrame(frame.number);
    for (const char* name : RunFolder::frame_folders) {
      const std::string image = path(name) + "/" + frameFileName(frame.number, ".png");
      if (!isThere(image))
        badInput(image, ": is missing; resume with the --output of the interrupted "
                        "run, and with --map-only if that run had it");
    }
  }
}

void
MappingOutput::writeFrame(const MappedFrame& mapped, const SemanticVoxelMap& map)
{
  replaceEarlierRun();
  if (has_images_)
    writeImages(mapped, map);
  else
    extra_->writeFrame(mapped);
  frames_.push_back(recordOf(mapped));
}

void
MappingOutput::writeImages(const MappedFrame& mapped, const SemanticVoxelMap& map) const
{
  const std::string name = "/" + frameFileName(mapped.frame.number, ".png");
  const double max_depth = run_.config.map.max_range;
  const RenderedLabels rendered =
      renderLabels(mapped.voxels, *run_.camera, mapped.T_world_camera, max_depth);
  writePng(path("labels" + name), rendered.labels);
  writePng(path("labels_at_depth" + name),
           labelsAtDepth(map, *mapped.cloud, mapped.T_world_camera, max_depth));
  writePng(path("network_labels" + name), networkLabels(mapped));
  writePng(path("overlay" + name),
           drawOverlay(mapped.image, rendered.labels, run_.label_set));
  extra_->writeFrame(mapped);
}

void
MappingOutput::writeLive(const MappedFrame& mapped) const
{
  const std::string live = path(RunFolder::live) + "/";
  makeOutputFolder(live);
  VoxelCloud voxels = mapped.voxels;
  if (centres_) {
    voxels.cloud = voxels.cloud->makeShared(); // keeps the points of the frame
    voxels.moveToCentres();
  }
  writeVoxelCloud(live + "map.pcd", voxels, run_.label_set, VoxelColour::measured);
  writeLabelSet(live + "label_set.yaml", run_.label_set);
  writeKittiTrajectory(live + "trajectory.txt", trajectory());
  const Json summary{{"finished", true},
                     {"voxel_size", mapped.voxels.voxel_size},
                     {"map_origin", toJson(mapped.voxels.origin)},
                     {"frame", mapped.frame.number}};
  writeTextFile(live + "summary.json", jsonText(summary));
}

void
MappingOutput::finish(const SemanticVoxelMap& map, const ObjectTracker* objects,
                      bool is_whole)
{
  replaceEarlierRun();
  VoxelCloud voxels = map.occupiedEverywhere();
  std::vector<ObjectSummary> things;
  if (objects) {
    voxels.objects = objects->numbers(voxels);
    things = objects->summarize(voxels);
  }
  std::vector<PlaneSummary> planes;
  if (run_.finds_planes) {
    CloudPlanes found = findPlanes(voxels.cloud, voxels.voxel_size, voxels.origin);
    planes = std::move(found.planes);
    voxels.planes = std::move(found.numbers);
  }
  writeFinalImages(voxels);
  if (centres_)
    voxels.moveToCentres();
  writeVoxelCloud(path("map.pcd"), voxels, run_.label_set, VoxelColour::measured);
  writeVoxelCloud(path("map_classes.pcd"), voxels, run_.label_set,
                  VoxelColour::classes);
  if (objects)
    writeThings(things);
  if (run_.finds_planes) {
    writePlanes(path("planes.json"), planes, run_.label_set);
    writePolygons(path("planes.ply"), planes, run_.label_set);
  }
  writeLabelSet(path("label_set.yaml"), run_.label_set);

  std::vector<Eigen::Vector3d> positions;
  for (const FrameRecord& frame : frames_)
    positions.push_back(frame.T_world_camera.translation());
  writeKittiTrajectory(path("trajectory.txt"), trajectory());
  writePng(path("top_view.png"), drawTopView(voxels, positions, run_.label_set));
  writeSummary(voxels, is_whole);
  RunFolder::endRun(folder_, is_whole);
}

void
MappingOutput::writeThings(const std::vector<ObjectSummary>& objects) const
{
  writeObjects(path("objects.json"), objects, run_.label_set);
  writeBoxes(path("boxes.ply"), objects, run_.label_set);
}

void
MappingOutput::writeFinalImages(const VoxelCloud& voxels) const
{
  const VoxelCloud no_voxels;
  const MapLabels labels(extra_->needsFinalLabels() ? voxels : no_voxels);
  for (const FrameRecord& frame : frames_) {
    const Eigen::Isometry3d& T_world_camera = frame.T_world_camera;
    if (has_images_)
      writePng(
          path("final_labels/" + frameFileName(frame.number, ".png")),
          renderLabels(voxels, *run_.camera, T_world_camera, run_.config.map.max_range)
              .labels);
    extra_->writeFinal(frame.number, T_world_camera, voxels, labels);
  }
}

// Row n is the pose of frame n, as in KITTI's files. A skipped frame gets the pose of
// the last mapped one before it.
Trajectory
MappingOutput::trajectory() const
{
  Trajectory poses;
  for (const FrameRecord& frame : frames_) {
    const Eigen::Isometry3d pose = worldFromFirstCamera().inverse() *
                                   frame.T_world_camera *
                                   run_.T_camera0_camera.inverse();
    poses.resize(std::size_t(frame.number), poses.empty() ? pose : poses.back());
    poses.push_back(pose);
  }
  return poses;
}

double
MappingOutput::domainShift() const
{
  std::vector<double> shifts;
  for (const FrameRecord& frame : frames_)
    if (frame.domain_shift >= 0.0) // false for NaN
      shifts.push_back(frame.domain_shift);
  return shifts.empty() ? std::numeric_limits<double>::quiet_NaN()
                        : quantile(shifts, 0.5);
}

void
MappingOutput::writeSummary(const VoxelCloud& voxels, bool is_whole) const
{
  Json summary;
  summary["finished"] = is_whole;
  for (const auto& [name, value] : run_.inputs)
    summary["inputs"][name] = value;
  summary["frames"] = frames_.size();
  summary["frame_numbers"] = Json::array();
  ScanCounts total;
  std::map<std::string, std::vector<double>> seconds; // by stage
  for (const FrameRecord& frame : frames_) {
    summary["frame_numbers"].push_back(frame.number);
    total.rays += frame.counts.rays;
    total.sky += frame.counts.sky;
    total.invalid += frame.counts.invalid;
    total.seen_through += frame.counts.seen_through;
    for (const auto& [stage, each] : frame.seconds)
      seconds[stage].push_back(each);
  }
  summary["points"] = {{"rays", total.rays},
                       {"sky", total.sky},
                       {"without_depth", total.invalid},
                       {"seen_through", total.seen_through}};
  summary["voxels"] = voxels.size();
  if (!voxels.objects.empty()) {
    const std::set<std::uint32_t> numbers(voxels.objects.begin(), voxels.objects.end());
    summary["objects"] = numbers.size() - numbers.count(0);
  }
  summary["voxel_size"] = voxels.voxel_size;
  summary["map_origin"] = toJson(voxels.origin);
  if (const double shift = domainShift(); shift >= 0.0) // false for NaN
    summary["domain_shift"] = shift;
  for (const auto& [stage, all] : seconds)
    summary["seconds"][stage] = {{"median", quantile(all, 0.5)},
                                 {"95 %", quantile(all, 0.95)}};
  MapperConfig config = run_.config;
  for (const ConfigParameter& parameter : parametersOf(config))
    summary["options"][parameter.name] = parameter.text();
  summary["versions"] = versions();
  writeTextFile(path("summary.json"), jsonText(summary));
}

} // namespace pcl_semantic
