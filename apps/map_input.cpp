// SPDX-License-Identifier: BSD-3-Clause
#include "map_input.h"
#include "files/is_there.h"
#include "files/other_formats.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/object_file.h>
#include <pcl_semantic/files/pose_doubts.h>
#include <pcl_semantic/io/map_archive.h>
#include <pcl_semantic/io/map_export.h>
#include <pcl_semantic/io/map_file.h>
#include <pcl_semantic/odometry/pose_source.h>
#include <pcl_semantic/pipeline/map_folder.h>

#include <boost/algorithm/string/case_conv.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace pcl_semantic::tool {

namespace {

namespace fs = std::filesystem;

bool
isCloud(const std::string& path)
{
  const std::string extension =
      boost::algorithm::to_lower_copy(fs::path(path).extension().string());
  const auto& extensions = cloudExtensions();
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

bool
isDatabase(const std::string& path)
{
  std::error_code error;
  if (!fs::is_regular_file(path, error)) // reading a pipe would block
    return false;
  std::string begin(6, '\0');
  std::ifstream(path).read(begin.data(), std::streamsize(begin.size()));
  return begin == "SQLite";
}

VoxelScene
readScene(const std::string& path, const MapHints& hints)
{
  const double voxel_size = hints.voxel_size;
  if (isFolder(path)) {
    const MapSummary summary = readMapSummary(path);
    if (!summary.is_whole)
      warn(path + ": the run was interrupted; the map holds the frames up to then");
    // Cube 0 starts at the world's origin; the points are relative to the map's origin.
    const double size = voxel_size > 0.0 ? voxel_size : summary.voxel_size;
    VoxelScene scene = readVoxelScene(path + "/map.pcd", {size, -summary.origin});
    scene.origin = summary.origin;
    return scene;
  }
  if (isCloud(path))
    return readVoxelScene(path, {voxel_size, Eigen::Vector3d::Zero()});
  if (voxel_size > 0.0)
    fail<InvalidParameterException>(
        "--voxel-size is for clouds: an archive has its own");
  try {
    return sceneOf(*loadMap(path), hints.free_space);
  }
  catch (const BadInputException&) {
    if (!isDatabase(path))
      refuseOtherFormats(path); // the path is not an archive
    throw;
  }
}

Trajectory
inWorld(const StoredTrajectory& trajectory)
{
  Trajectory poses;
  for (const TimedPose& timed : trajectory.poses)
    poses.push_back(worldFromFirstCamera() * timed.pose);
  return poses;
}

LabelSet
labelSetOf(const std::string& path, const MapHints& hints, const VoxelScene& scene)
{
  LabelSet label_set;
  const std::string own = path + "/label_set.yaml"; // part of a map folder
  if (hints.label_set.empty() && isFolder(path) && isThere(own))
    label_set = readLabelSet(own);
  else if (hints.label_set.empty() && !isFolder(path) && !isCloud(path))
    label_set = MapReader::open(path)->header().label_set;
  else
    label_set = readLabelSetOrDefault(hints.label_set);
  const int classes = scene.voxels.refined.classes();
  if (classes > 0 && classes != label_set.size())
    fail<BadInputException>(path, ": has ", classes, " classes, the label set ",
                            label_set.size(), "; name its own with --label-set");
  return label_set;
}

} // namespace

MapInput
readMap(const std::string& path, const MapHints& hints)
{
  MapInput map;
  map.scene = readScene(path, hints);
  warnOf(map.scene.doubts);
  map.label_set = labelSetOf(path, hints, map.scene);
  if (!hints.trajectory.empty()) {
    const StoredTrajectory read =
        readTrajectory(hints.trajectory, PoseFrame::first_camera);
    warnOf(read.doubts);
    map.T_world_camera = inWorld(read);
  }
  else if (isFolder(path) && isThere(path + "/trajectory.txt"))
    map.T_world_camera =
        inWorld(readTrajectory(path + "/trajectory.txt", PoseFrame::first_camera));
  return map;
}

std::vector<ObjectSummary>
readMapObjects(const std::string& path, const std::string& file,
               const LabelSet& label_set)
{
  if (file == "none")
    return {};
  if (!file.empty())
    return readObjects(file, label_set);
  if (!isFolder(path))
    return isCloud(path) ? std::vector<ObjectSummary>()
                         : describeObjects(*MapReader::open(path));
  const std::string own = path + "/objects.json";
  return isThere(own) ? readObjects(own, label_set) : std::vector<ObjectSummary>();
}

void
requireVoxels(const std::string& path, const MapInput& map)
{
  if (map.scene.voxels.size() == 0)
    fail<BadInputException>(path, ": has no point: there is nothing to draw");
}

VoxelScene
readOtherMap(const std::string& path, const MapHints& hints, const VoxelScene& like)
{
  if (isCloud(path) && hints.voxel_size <= 0.0)
    return readVoxelScene(path, {}, {like.grid.size, like.grid.corner + like.origin});
  return readScene(path, hints);
}

Trajectory
posesInScene(const MapInput& map)
{
  Trajectory poses = map.T_world_camera;
  for (Eigen::Isometry3d& pose : poses)
    pose.translation() -= map.scene.origin + map.scene.grid.corner;
  return poses;
}

} // namespace pcl_semantic::tool
