/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// One frame of KITTI into the map, with colour and eleven labels, against OctoMap's
// occupancy alone: the same points, the same range, two threads.

#include "bench/kitti_map.h"
#include "bench/ratio.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>
#include <pcl_semantic/stereo/sgbm.h>

#include <octomap/octomap.h>

#include <cstdio>
#include <limits>

namespace {

using namespace pcl_semantic;

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

// Sky casts no ray in our map, and OctoMap knows no sky: it is taken out for both.
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
  const std::string data = realDataFolder();
  const KittiSequence sequence(data + "/kitti/" + name);
  const NetworkDescription network =
      readNetworkDescription(std::string(PCL_SEMANTIC_SOURCE_DIR) +
                             "/data/networks/espnetv2_city_1280x480.yaml");
  const LabelSet label_set = readLabelSet(labelSetPath());
  NetworkPredictor predictor(network, label_set,
                             data + "/nets/espnetv2_s2.0_city_1280x480_halfres.onnx");
  TrajectoryPoses poses(readKittiTrajectory(sequence.posesPath()),
                        sequence.T_camera0_camera());
  Sgbm stereo((Sgbm::Parameters()));
  std::vector<BenchFrame> frames;
  for (std::size_t i = 0; i < std::min<std::size_t>(sequence.size(), 8); ++i) {
    const StereoFrame images = sequence.frame(i);
    frames.push_back({disparityToCloud(stereo.estimate(images.left, images.right),
                                       images.left, sequence.camera()),
                      predictor.predict(images), poses.pose(images)});
    removeSky(label_set, frames.back());
  }
  return frames;
}

double
median(std::vector<double> values)
{
  std::nth_element(values.begin(), values.begin() + long(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
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

void
compare(const std::string& name, const std::vector<BenchFrame>& frames, double range,
        double target)
{
  std::printf("KITTI %s, rays to %.0f m\n", name.c_str(), range);
  const double ours = ourSeconds(frames, range);
  const double octomap = octomapSeconds(frames, range);
  std::printf("  a frame: ours %.1f ms, OctoMap %.1f ms\n", 1e3 * ours, 1e3 * octomap);
  printRatio("map_" + name + "_" + std::to_string(int(range)) + "m_vs_octomap",
             octomap / ours, target);
}

} // namespace

int
main()
{
  setNumberOfThreads(2);
  if (realDataFolder().empty()) {
    std::printf("PCL_SEMANTIC_DATA is not set: nothing to compare\n");
    return 0;
  }
  for (const char* const name : {"15", "05"}) {
    const std::vector<BenchFrame> frames = readFrames(name);
    compare(name, frames, 20.0, 15.0);
    compare(name, frames, 40.0, 40.0);
  }
  return 0;
}
