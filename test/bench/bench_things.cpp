// SPDX-License-Identifier: BSD-3-Clause

// Objects of the scans of KITTI with perfect labels, compared with a search of all
// voxels around each voxel and with pcl::EuclideanClusterExtraction. One thread.

#include "bench/kitti_map.h"
#include "bench/ratio.h"
#include "core/disjoint_sets.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/dataset/kitti_calibration.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/things/object_extraction.h>

#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <set>
#include <unordered_map>

namespace {

using namespace pcl_semantic;

constexpr double kVoxel = 0.1, kGap = 0.7; // [m]

using Cloud = pcl::PointCloud<pcl::PointXYZL>;

// The voxels of the things in all scans of a sequence, one point at each corner.
Cloud::Ptr
thingsOf(const std::string& sequence, const LabelSet& label_set)
{
  const LabelMapping mapping = readLabelMapping("semantic_kitti_to_kitti11", label_set);
  const Trajectory poses = readKittiTrajectory(sequence + "/poses.txt");
  const Eigen::Isometry3d T_camera0_laser =
      readKittiCalibration(sequence + "/calib.txt", KittiCameras::colour)
          .T_camera0_velodyne.value();
  std::set<std::array<int, 4>> voxels; // z, y, x, label
  std::vector<std::string> scans;
  for (const auto& entry : std::filesystem::directory_iterator(sequence + "/velodyne"))
    scans.push_back(entry.path().string());
  std::sort(scans.begin(), scans.end());
  for (std::size_t s = 0; s < scans.size() && s < poses.size(); ++s) {
    const LabelledCloud scan = readLabelledCloud(scans[s], &mapping);
    const Eigen::Isometry3d pose = poses[s] * T_camera0_laser;
    for (const pcl::PointXYZRGBL& point : *scan.cloud)
      if (point.label != kUnlabelled && label_set[Label(point.label)].thing) {
        const Eigen::Array3d place = pose * point.getVector3fMap().cast<double>();
        const Eigen::Array3i voxel = (place / kVoxel).floor().cast<int>();
        voxels.insert({voxel.z(), voxel.y(), voxel.x(), int(point.label)});
      }
  }
  Cloud::Ptr cloud(new Cloud);
  for (const auto& [z, y, x, label] : voxels) {
    pcl::PointXYZL point;
    point.x = float(x * kVoxel);
    point.y = float(y * kVoxel);
    point.z = float(z * kVoxel);
    point.label = std::uint32_t(label);
    cloud->push_back(point);
  }
  return cloud;
}

// Looks at all voxels within the gap around each voxel. \return the number of objects
std::size_t
naive(const Cloud& cloud)
{
  using Key = std::pair<VoxelIndex, Label>;
  const auto hash = [](const Key& key) {
    return VoxelIndexHash()(key.first) * 31 + key.second;
  };
  std::unordered_map<Key, int, decltype(hash)> numbers(cloud.size(), hash);
  const auto keyOf = [](const pcl::PointXYZL& point) {
    return Key((point.getArray3fMap().cast<double>() / kVoxel).round().cast<int>(),
               Label(point.label));
  };
  for (std::size_t i = 0; i < cloud.size(); ++i)
    numbers.emplace(keyOf(cloud[i]), int(i));
  DisjointSets sets;
  sets.grow(cloud.size());
  const int reach = int(kGap / kVoxel + 1e-9);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Key key = keyOf(cloud[i]);
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
          if (x * x + y * y + z * z > reach * reach)
            continue;
          const auto found =
              numbers.find({key.first + VoxelIndex(x, y, z), key.second});
          if (found != numbers.end())
            sets.joinMembers(int(i), found->second);
        }
  }
  std::size_t objects = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    objects += sets.rootOf(int(i)) == int(i);
  return objects;
}

std::size_t
byPcl(const Cloud::Ptr& cloud, const LabelSet& label_set)
{
  std::size_t objects = 0;
  for (int label = 1; label <= label_set.size(); ++label) {
    const auto members = pcl::make_shared<pcl::Indices>();
    for (std::size_t i = 0; i < cloud->size(); ++i)
      if ((*cloud)[i].label == std::uint32_t(label))
        members->push_back(pcl::index_t(i));
    if (members->empty())
      continue;
    pcl::EuclideanClusterExtraction<pcl::PointXYZL> extraction;
    extraction.setInputCloud(cloud);
    extraction.setIndices(members);
    extraction.setSearchMethod(pcl::make_shared<pcl::search::KdTree<pcl::PointXYZL>>());
    extraction.setClusterTolerance(kGap + 1e-4);
    std::vector<pcl::PointIndices> clusters;
    extraction.extract(clusters);
    objects += clusters.size();
  }
  return objects;
}

} // namespace

int
main()
{
  const std::string data = realDataFolder();
  if (data.empty()) {
    std::puts("skipped: PCL_SEMANTIC_DATA is not set");
    return 0;
  }
  setNumberOfThreads(1);
  const LabelSet label_set =
      readLabelSet(PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml");
  double ours = 0.0, plain = 0.0, theirs = 0.0;
  std::size_t objects = 0, voxels = 0;
  for (const char* const name : {"00", "01", "03", "05", "06", "07", "09"}) {
    const Cloud::Ptr cloud = thingsOf(data + "/kitti/" + name, label_set);
    ObjectExtraction<pcl::PointXYZL> extraction;
    extraction.setInputCloud(cloud);
    extraction.setLabelSet(label_set);
    extraction.setGap(kGap + 1e-4); // positions are rounded to single precision
    std::vector<pcl::PointIndices> found;
    ours += medianSeconds(9, [&] { extraction.extract(found); });
    std::size_t expected = 0, of_pcl = 0;
    plain += medianSeconds(3, [&] { expected = naive(*cloud); });
    theirs += medianSeconds(3, [&] { of_pcl = byPcl(cloud, label_set); });
    if (found.size() != expected || of_pcl != expected)
      std::printf("%s: %zu objects, expected %zu; PCL's %zu\n", name, found.size(),
                  expected, of_pcl);
    objects += found.size();
    voxels += cloud->size();
  }
  std::printf("%zu objects in %zu voxels: ours %.1f ms, naive %.1f ms, PCL's %.1f ms\n",
              objects, voxels, 1e3 * ours, 1e3 * plain, 1e3 * theirs);
  printRatio("things_vs_naive", plain / ours, 11);
  printRatio("things_vs_euclidean_clusters", theirs / ours, 11);
  return 0;
}
