// SPDX-License-Identifier: BSD-3-Clause
#include "doors.h"

#include "files/pcd_file.h"
#include "io/archive_database.h"
#include "io/archive_objects.h"
#include "io/block_encoding.h"
#include "io/tiled_map.h"
#include "labelling/onnx_interface.h"
#include "support/archives.h"
#include "support/temporary_folder.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/dataset/pinhole_camera.h>
#include <pcl_semantic/dataset/stereo_rig.h>
#include <pcl_semantic/dataset/undistorter.h>
#include <pcl_semantic/evaluation/depth_file.h>
#include <pcl_semantic/files/clique_file.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/config_file.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/npy_file.h>
#include <pcl_semantic/files/object_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/io/map_export.h>
#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/labelling/network_predictor.h>
#include <pcl_semantic/pipeline/fleet_plan.h>
#include <pcl_semantic/pipeline/map_folder.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/pipeline/run_description.h>

#include <filesystem>
#include <mutex>
#include <stdexcept>

namespace pcl_semantic {

namespace {

constexpr int kColumns = 8, kRows = 4, kClasses = 3;

const TemporaryFolder&
scratch()
{
  static const TemporaryFolder folder(TemporaryFolder::memory());
  return folder;
}

std::string
fileOf(const std::string& bytes, const std::string& name)
{
  return scratch().write(name, bytes);
}

std::vector<std::uint8_t>
toBytes(const std::string& bytes)
{
  return {bytes.begin(), bytes.end()};
}

void
readArchive(const std::string& bytes)
{
  const std::string path = fileOf(bytes, "archive.map");
  verifyArchive(path);
  readVoxels(MapArchive(path, ArchiveAccess::read), {});
}

void
readBlock(const std::string& bytes)
{
  decodeBlock(toBytes(bytes), VoxelIndex(1, -2, 3), kClasses);
}

// Reads a camera and makes the maps of its lens, for small images.
void
undistort(const std::string& path)
{
  const PinholeCamera camera = readPinholeCamera(path);
  const bool is_small = camera.width > 0 && camera.width * camera.height <= 10000;
  Undistorter(camera, is_small ? camera.width : 64, is_small ? camera.height : 48,
              "0.png");
}

void
readDepthPng(const std::string& bytes)
{
  readDepths(fileOf(bytes, "depth.png"));
}

// Creates the one tile, with a block, that is named by the corpus's index.
void
readTileIndex(const std::string& bytes)
{
  static std::once_flag once;
  std::call_once(once, [] {
    std::filesystem::create_directories(scratch().path("tiles"));
    ArchiveHeader header;
    header.label_set = threeClasses();
    const auto tile = MapArchive::create(scratch().path("tiles/0_0.map"), header);
    tile->put(VoxelIndex(0, 0, 0), VoxelBlock());
    tile->commit({});
    tile->close();
  });
  TiledMap(fileOf(bytes, "map.tiles"));
}

// The label set named by the corpus is beside it.
void
readNetworkFile(const std::string& bytes)
{
  static std::once_flag once;
  std::call_once(once,
                 [] { writeLabelSet(scratch().path("classes.yaml"), threeClasses()); });
  readNetworkDescription(fileOf(bytes, "net.yaml"));
}

// Throws an exception that no test accepts as a refusal.
void
require(bool is_right, const char* what)
{
  if (!is_right)
    throw std::logic_error(what);
}

void
requireIndices(const std::vector<pcl::PointIndices>& cliques, std::size_t points)
{
  for (const pcl::PointIndices& clique : cliques) {
    require(!clique.indices.empty(), "a clique is empty");
    for (const pcl::index_t index : clique.indices)
      require(index >= 0 && std::size_t(index) < points, "a clique has no such point");
  }
}

void
readCloud(const std::string& path)
{
  const LabelledCloud read = readLabelledCloud(path);
  const PcdTable& table = read.table;
  require(table.data.size() == table.points() * table.point_step &&
              table.points() == read.cloud->size(),
          "data and points differ");
  for (const pcl::PointXYZRGBL& point : *read.cloud)
    require(point.label <= 255, "a label is beyond 255");
  requireIndices(read.cliques, table.points());
}

void
readArray(const std::string& path)
{
  const NpyArray array = readNpy(path);
  require(array.values.size() == Eigen::Index(array.height) * array.width * array.depth,
          "values and sizes differ");
}

template <typename Config, void (*read)(const std::string&, Config&)>
void
readConfigFile(const std::string& bytes)
{
  Config config;
  read(fileOf(bytes, "config.yaml"), config);
}

void
readDistributionsOf(const std::string& bytes, const char* name)
{
  readDistributions(fileOf(bytes, name), kColumns, kRows, kClasses, 0.8f);
}

} // namespace

const std::vector<Door>&
doors()
{
  static const std::vector<Door> all{
      {"archive", readArchive},
      {"archive_block", readBlock},
      {"archive_frame", [](const std::string& b) { decodeFrameRecord(7, toBytes(b)); }},
      {"archive_object", [](const std::string& b) { decodeObject(toBytes(b)); }},
      {"archive_objects", [](const std::string& b) { decodeObjectList(toBytes(b)); }},
      {"archive_seal",
       [](const std::string& b) { unseal(b.data(), b.size(), 1 << 16); }},
      {"calibration",
       [](const std::string& b) {
         readCalibration(fileOf(b, "calibration.yaml"), threeClasses());
       }},
      {"cliques",
       [](const std::string& b) {
         requireIndices(readCliques(fileOf(b, "c.txt"), 100), 100);
       }},
      {"cloud_pcd", [](const std::string& b) { readCloud(fileOf(b, "c.pcd")); }},
      {"cloud_ply", [](const std::string& b) { readCloud(fileOf(b, "c.ply")); }},
      {"crf_config", readConfigFile<CRFConfig, readConfig<CRFConfig>>},
      {"depth_png", readDepthPng},
      {"depth_tif", [](const std::string& b) { readDepthImage(fileOf(b, "d.tif")); }},
      {"distributions_bin",
       [](const std::string& b) { readDistributionsOf(b, "d.bin"); }},
      {"distributions_npy",
       [](const std::string& b) { readDistributionsOf(b, "d.npy"); }},
      {"distributions_packed",
       [](const std::string& b) { readDistributionsOf(b, "d.npy.zst"); }},
      {"distributions_png",
       [](const std::string& b) { readDistributionsOf(b, "d.png"); }},
      {"fleet_plan",
       [](const std::string& b) { readFleetPlan(fileOf(b, "plan.yaml")); }},
      {"image_jpg", [](const std::string& b) { readImage(fileOf(b, "i.jpg")); }},
      {"image_png", [](const std::string& b) { readImage(fileOf(b, "i.png")); }},
      {"image_tif", [](const std::string& b) { readImage(fileOf(b, "i.tif")); }},
      {"kitti_calibration",
       [](const std::string& b) {
         readKittiCalibration(fileOf(b, "calib.txt"), KittiCameras::colour);
       }},
      {"label_mapping",
       [](const std::string& b) {
         readLabelMapping(fileOf(b, "mapping.yaml"), threeClasses());
       }},
      {"label_set", [](const std::string& b) { readLabelSet(fileOf(b, "set.yaml")); }},
      {"mapper_config", readConfigFile<MapperConfig, readMapperConfig>},
      {"network", readNetworkFile},
      {"network_onnx",
       [](const std::string& b) { readOnnxInterface(toBytes(b), "net.onnx"); }},
      {"npy", [](const std::string& b) { readArray(fileOf(b, "a.npy")); }},
      {"objects",
       [](const std::string& b) { readObjects(fileOf(b, "o.json"), threeClasses()); }},
      {"pinhole_camera",
       [](const std::string& b) { readPinholeCamera(fileOf(b, "camera.yaml")); }},
      {"pinhole_camera_txt",
       [](const std::string& b) { readPinholeCamera(fileOf(b, "calib.txt")); }},
      {"poses_frame",
       [](const std::string& b) { readPoseFile(fileOf(b, "0.pose.txt")); }},
      {"poses_kitti",
       [](const std::string& b) { readKittiTrajectory(fileOf(b, "poses.txt")); }},
      {"poses_tum",
       [](const std::string& b) { readTumTrajectory(fileOf(b, "poses.txt")); }},
      {"run_description",
       [](const std::string& b) {
         sensorOf(b);
         configOf(b);
       }},
      {"scan_bin", [](const std::string& b) { readVelodyneScan(fileOf(b, "s.bin")); }},
      {"scan_labels",
       [](const std::string& b) { readScanLabels(fileOf(b, "s.label"), kClasses); }},
      {"stereo_rig",
       [](const std::string& b) { readStereoRig(fileOf(b, "rig.yaml")); }},
      {"summary",
       [](const std::string& b) {
         fileOf(b, "summary.json");
         readMapSummary(scratch().path(""));
       }},
      {"tile_index", readTileIndex},
      {"times", [](const std::string& b) { readTimes(fileOf(b, "times.txt")); }},
      {"undistorter",
       [](const std::string& b) { undistort(fileOf(b, "camera.yaml")); }}};
  return all;
}

void
tryDoor(const Door& door, const std::string& bytes)
{
  const auto requireLine = [&](const std::string& message) {
    if (message.empty() || message.find('\n') != std::string::npos)
      throw std::logic_error(door.name + ": refused by no line: '" + message + "'");
  };
  try {
    door.read(bytes);
  }
  catch (const BadInputException& error) {
    requireLine(error.what());
  }
  catch (const BadModelException& error) {
    requireLine(error.what());
  }
}

} // namespace pcl_semantic
