// SPDX-License-Identifier: BSD-3-Clause

// One frame of KITTI added to the map, with colour and eleven labels, compared with
// OctoMap's occupancy only: the same points, the same range, two threads. Then the
// occupied cloud of a window, its memory, and the constancy of times over thousands of
// frames.

#include "bench/kitti_map.h"
#include "bench/median.h"
#include "bench/ratio.h"
#include "support/random_scan.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <octomap/octomap.h>

#include <cstdio>
#include <fstream>
#include <limits>
#include <map>

namespace {

using namespace pcl_semantic;

// Discards blocks that leave the window, so that only the map is measured.
class ForgetfulStore : public BlockStore {
public:
  void
  put(const VoxelIndex&, const VoxelBlock&) override
  {}

  std::unique_ptr<VoxelBlock>
  get(const VoxelIndex&) const override
  {
    return nullptr;
  }

  void
  forEach(
      const std::function<void(const VoxelIndex&, const VoxelBlock&)>&) const override
  {}
};

std::size_t
residentBytes()
{
  std::size_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * 4096;
}

struct BenchFrame {
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud; // without sky
  LabelDistributions distributions;
  Eigen::Isometry3d T_world_camera;
};

std::string
labelSetPath()
{
  return std::string(PCL_SEMANTIC_SOURCE_DIR) + "/data/label_sets/kitti11.yaml";
}

// Sky casts no ray in the map, and OctoMap has no such class: it is removed for both.
void
removeSky(const LabelSet& label_set, BenchFrame& frame)
{
  for (std::size_t i = 0; i < frame.cloud->size(); ++i)
    if (label_set[frame.distributions.mapLabel(Eigen::Index(i))].sky)
      (*frame.cloud)[i].x = std::numeric_limits<float>::quiet_NaN();
}

std::vector<BenchFrame>
readFrames(const std::string& name)
{
  const KittiSequence sequence(realDataFolder() + "/kitti/" + name);
  const LabelSet label_set = readLabelSet(labelSetPath());
  const auto predictor = kittiNetwork();
  const auto poses = readPoses(sequence.posesPath(), sequence.T_camera0_camera());
  const auto stereo = makeDisparityEstimator("sgbm", 128);
  std::vector<BenchFrame> frames;
  for (std::size_t i = 0; i < std::min<std::size_t>(sequence.size(), 8); ++i) {
    const StereoFrame images = sequence.frame(i);
    frames.push_back(
        {disparityToCloud(stereo->estimate(images.left, images.right).disparity,
                          images.left, sequence.camera()),
         predictor->predict(images.left, images.number), poses->pose(images)});
    removeSky(label_set, frames.back());
  }
  return frames;
}

octomap::Pointcloud
octomapPoints(const BenchFrame& frame)
{
  octomap::Pointcloud points;
  for (const pcl::PointXYZRGB& point : *frame.cloud)
    if (point.getVector3fMap().allFinite()) {
      const Eigen::Vector3f world =
          (frame.T_world_camera * point.getVector3fMap().cast<double>()).cast<float>();
      points.push_back(world.x(), world.y(), world.z());
    }
  return points;
}

double
octomapSeconds(const std::vector<BenchFrame>& frames, double range)
{
  octomap::OcTree tree(0.1);
  std::vector<double> seconds;
  for (const BenchFrame& frame : frames) {
    const octomap::Pointcloud points = octomapPoints(frame);
    const Eigen::Vector3f sensor = frame.T_world_camera.translation().cast<float>();
    seconds.push_back(secondsOf([&] {
      tree.insertPointCloud(points, {sensor.x(), sensor.y(), sensor.z()}, range, true,
                            true);
    }));
  }
  return median(seconds);
}

double
ourSeconds(const std::vector<BenchFrame>& frames, double range)
{
  SemanticVoxelMap::Parameters parameters;
  parameters.max_range = range;
  parameters.window = {2.0 * range + 8.0, 2.0 * range + 8.0, 32.0};
  SemanticVoxelMap map(readLabelSet(labelSetPath()), parameters);
  std::vector<double> seconds;
  std::size_t rays = 0;
  for (const BenchFrame& frame : frames)
    seconds.push_back(secondsOf([&] {
      rays +=
          map.integrate(*frame.cloud, frame.T_world_camera, frame.distributions).rays;
    }));
  std::printf("  %zu rays a frame, %zu occupied voxels at the end\n",
              rays / frames.size(), map.occupied().size());
  return median(seconds);
}

struct Street {
  std::string name;
  std::vector<BenchFrame> frames;
  std::map<double, double> seconds; // per frame of the map, by range
};

void
compareWithOctomap(Street& street, double range, double target)
{
  const double ours = street.seconds.at(range);
  const double octomap = octomapSeconds(street.frames, range);
  std::printf("KITTI %s, rays to %.0f m, a frame: ours %.1f ms, OctoMap %.1f ms\n",
              street.name.c_str(), range, 1e3 * ours, 1e3 * octomap);
  printRatio("map_" + street.name + "_" + std::to_string(int(range)) + "m_vs_octomap",
             octomap / ours, target);
}

// Compares the extraction of a full window, as a cloud with its distributions, with a
// copy of the same bytes.
void
compareExtraction(const std::vector<BenchFrame>& frames)
{
  SemanticVoxelMap map(readLabelSet(labelSetPath()), SemanticVoxelMap::Parameters());
  for (const BenchFrame& frame : frames)
    map.integrate(*frame.cloud, frame.T_world_camera, frame.distributions);
  const VoxelCloud voxels = map.occupied();
  const std::size_t bytes =
      voxels.size() *
      (sizeof(pcl::PointXYZRGBL) + sizeof(VoxelIndex) + sizeof(std::uint32_t) +
       2 * sizeof(float) * std::size_t(voxels.measured.classes()));
  const std::vector<char> source(bytes, 1);
  const double extraction = medianSeconds(9, [&] { map.occupied(); });
  const double copy = medianSeconds(9, [&] { std::vector<char> target(source); });
  std::printf("extraction: %zu voxels, %.1f ms; a copy of %.1f MB %.1f ms: %.1f times "
              "as long, wanted at most 6\n",
              voxels.size(), 1e3 * extraction, 1e-6 * double(bytes), 1e3 * copy,
              extraction / copy);
  printRatio("map_copy_times_6_vs_extraction", 6.0 * copy / extraction, 1.0);
}

// The paper's released code uses 61 bytes per voxel of the window.
void
compareMemory(const std::vector<BenchFrame>& frames, const char* name,
              const SemanticVoxelMap::Parameters& parameters, double most)
{
  SemanticVoxelMap map(readLabelSet(labelSetPath()), parameters);
  for (const BenchFrame& frame : frames)
    map.integrate(*frame.cloud, frame.T_world_camera, frame.distributions);
  const double mebi = 1024.0 * 1024.0;
  const double ours = double(map.memory()) / mebi;
  const Eigen::Vector3d cells = map.parameters().window / parameters.voxel_size;
  const double dense = 61.0 * cells.prod() / mebi;
  std::printf(
      "memory of the %s window: %.0f MiB for %zu occupied voxels, wanted at most "
      "%.0f; dense arrays %.0f MiB\n",
      name, ours, map.occupied().size(), most, dense);
  printRatio(std::string("map_") + name + "_window_memory", most / ours, 1.0);
}

// A room that moves with the sensor through new blocks, at a random position in each:
// constant work per frame.
void
printConstancy()
{
  SemanticVoxelMap::Parameters parameters;
  parameters.window = {12.0, 12.0, 6.0};
  parameters.max_range = 5.0;
  const LabelSet label_set = readLabelSet(labelSetPath());
  SemanticVoxelMap map(label_set, parameters, std::make_shared<ForgetfulStore>());
  const LabelledScan scan = makeRandomScan(4000, 5.0f, label_set.size(), 1);
  constexpr int frames = 5000;
  std::vector<double> seconds;
  std::size_t work[2] = {};
  std::size_t memory[2] = {};
  for (int i = 0; i < frames; ++i) {
    // An integer number of blocks, so that the quantised rays are the same.
    const Eigen::Isometry3d pose(Eigen::Translation3d(0.8 * i, 0.0, 0.0));
    ScanCounts counts;
    seconds.push_back(secondsOf(
        [&] { counts = map.integrate(scan.cloud, pose, scan.distributions); }));
    if (i == 200 || i == frames - 1) {
      work[i != 200] = counts.rays + counts.hit_voxels;
      memory[i != 200] = residentBytes();
    }
  }
  const double early = median({seconds.begin() + 100, seconds.begin() + 200});
  const double late = median({seconds.end() - 100, seconds.end()});
  std::printf(
      "%d frames: %.2f ms at the hundredth, %.2f ms at the end; work %zu and %zu; "
      "resident %.1f and %.1f MiB\n",
      frames, 1e3 * early, 1e3 * late, work[0], work[1], double(memory[0]) / 1048576.0,
      double(memory[1]) / 1048576.0);
  printRatio("map_constancy_times_1.15", 1.15 * early / late, 1.0);
}

SemanticVoxelMap::Parameters
paperWindow()
{
  SemanticVoxelMap::Parameters parameters;
  parameters.window = {25.0, 25.0, 8.0};
  return parameters;
}

} // namespace

int
main()
{
  setNumberOfThreads(2);
  printConstancy();
  if (realDataFolder().empty()) {
    std::printf("PCL_SEMANTIC_DATA is not set: nothing to compare\n");
    return 0;
  }
  std::vector<Street> streets;
  for (const char* const name : {"15", "05"}) {
    Street street{name, readFrames(name), {}};
    std::printf("KITTI %s\n", name);
    for (const double range : {20.0, 40.0})
      street.seconds[range] = ourSeconds(street.frames, range);
    compareExtraction(street.frames);
    compareMemory(street.frames, "paper", paperWindow(), 64.0);
    compareMemory(street.frames, "default", SemanticVoxelMap::Parameters(), 256.0);
    streets.push_back(std::move(street));
  }
  // Last, because the millions of nodes it frees slow down the heap afterwards.
  for (Street& street : streets) {
    compareWithOctomap(street, 20.0, 15.0);
    compareWithOctomap(street, 40.0, 40.0);
  }
  return 0;
}
