// SPDX-License-Identifier: BSD-3-Clause

// Planes of an indoor map, compared with PCL's region growing with normals of a kd-tree
// on the same points. One thread.

#include "bench/kitti_map.h"
#include "bench/ratio.h"

#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/dataset/pinhole_camera.h>
#include <pcl_semantic/dataset/rgbd_sequence.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/things/plane_extraction.h>

#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing.h>

#include <cstdio>
#include <string>

namespace {

using namespace pcl_semantic;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr float kVoxel = 0.02f;  // [m]
constexpr double kRadius = 0.15; // of normals [m]
constexpr std::size_t kPoints = 160000;

// The voxels of a kitchen, each with the mean of its points.
Cloud::Ptr
kitchen(const std::string& folder)
{
  const RgbdSequence sequence(folder, readPinholeCamera(folder + "/camera.yaml"));
  const Trajectory poses = readKittiTrajectory(folder + "/poses.txt");
  Cloud::Ptr all(new Cloud);
  for (std::size_t i = 0; i < sequence.size() && i < poses.size(); ++i) {
    const RgbdFrame frame = sequence.frame(i);
    for (const auto& point : *frame.cloud)
      if (point.z > 0.0f && point.z < 4.0f) { // not NaN
        const Eigen::Vector3f p =
            (poses[i] * point.getVector3fMap().cast<double>()).cast<float>();
        all->push_back({p.x(), p.y(), p.z()});
      }
  }
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setLeafSize(kVoxel, kVoxel, kVoxel);
  grid.setInputCloud(all);
  Cloud::Ptr cloud(new Cloud);
  grid.filter(*cloud);
  if (cloud->size() > kPoints)
    cloud->resize(kPoints);
  return cloud;
}

std::size_t
byPcl(const Cloud::Ptr& cloud)
{
  const auto tree = pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>();
  const auto normals = pcl::make_shared<pcl::PointCloud<pcl::Normal>>();
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setSearchMethod(tree);
  estimation.setInputCloud(cloud);
  estimation.setRadiusSearch(kRadius);
  estimation.compute(*normals);
  pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
  growing.setSearchMethod(tree);
  growing.setInputCloud(cloud);
  growing.setInputNormals(normals);
  growing.setNumberOfNeighbours(30);
  growing.setSmoothnessThreshold(0.15f);
  growing.setMinClusterSize(300);
  std::vector<pcl::PointIndices> clusters;
  growing.extract(clusters);
  return clusters.size();
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
  const Cloud::Ptr cloud = kitchen(data + "/kitchen");
  PlaneExtraction<pcl::PointXYZ> extraction;
  PlaneParameters parameters;
  parameters.radius = kRadius;
  extraction.setParameters(parameters);
  extraction.setInputCloud(cloud);
  std::size_t planes = 0, clusters = 0;
  const double ours = medianSeconds(9, [&] { planes = extraction.extract().size(); });
  const double theirs = medianSeconds(3, [&] { clusters = byPcl(cloud); });
  std::printf("%zu points: %zu planes in %.3f s; PCL: %zu regions in %.3f s\n",
              cloud->size(), planes, ours, clusters, theirs);
  printRatio("planes_vs_region_growing", theirs / ours, 10);
  return 0;
}
