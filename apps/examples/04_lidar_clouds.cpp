// SPDX-License-Identifier: BSD-3-Clause

// 04: labelled clouds of any sensor, with their poses, become a map.
//
//   04_lidar_clouds                      a simulated laser on the synthetic street
//   04_lidar_clouds FOLDER [MAP.pcd]     FOLDER/0.pcd, 1.pcd and so on with x y z label
//       (or probability), in the sensor's frame; line n of FOLDER/poses.txt is
//       T_world_sensor of n.pcd, the upper 3 x 4 row by row

#include "synthesize/street.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/voxel_cloud_file.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/odometry/pose_source.h>

#include <iostream>

using namespace pcl_semantic;

namespace {

// Works for any point type with x y z and any distributions. Without distributions a
// cloud updates only occupancy and colour.
template <typename PointT>
void
addCloud(const pcl::PointCloud<PointT>& cloud, const Eigen::Isometry3d& T_world_sensor,
         SemanticVoxelMap& map)
{
  LabelDistributions labels(map.labelSet().size(), Eigen::Index(cloud.size()));
  for (std::size_t i = 0; i < cloud.size(); ++i)
    labels.setLabel(Eigen::Index(i), Label(cloud[i].label), 0.8f); // correct with 80 %
  map.integrate(cloud, T_world_sensor, labels);
}

void
addFolder(const std::string& folder, SemanticVoxelMap& map)
{
  const Trajectory poses = readKittiTrajectory(folder + "/poses.txt");
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::string path = folder + "/" + std::to_string(i) + ".pcd";
    LabelledCloud read = readLabelledCloud(path);
    addOrigin(read); // scans are relative to their sensor
    addCloud(*read.cloud, poses[i], map);
  }
}

// Simulates 32 rings of 720 rays, x forward, y left, z up, with the label of each hit.
pcl::PointCloud<pcl::PointXYZL>
scan(const SyntheticScene& street, const Eigen::Isometry3d& T_world_sensor)
{
  pcl::PointCloud<pcl::PointXYZL> cloud;
  for (int ring = 0; ring < 32; ++ring)
    for (int step = 0; step < 720; ++step) {
      const double up = 0.01 * ring - 0.25, turn = M_PI / 360.0 * step;
      const Eigen::Vector3d ray(std::cos(turn) * std::cos(up),
                                std::sin(turn) * std::cos(up), std::sin(up));
      const SyntheticHit hit =
          street.intersect(T_world_sensor.translation(), T_world_sensor.linear() * ray);
      const Eigen::Vector3f point = (ray * hit.distance).cast<float>();
      if (hit.label != synthetic_sky) // no return
        cloud.emplace_back(point.x(), point.y(), point.z(), hit.label);
    }
  return cloud;
}

} // namespace

int
main(int argc, char** argv)
try {
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = 0.2;
  parameters.max_range = 25.0;
  SemanticVoxelMap map(readLabelSet(findDataFile("label_sets/kitti11.yaml")),
                       parameters);
  if (argc > 1)
    addFolder(argv[1], map);
  const SyntheticScene street(1, 4);
  for (int frame = 0; argc < 2 && frame < street.frames(); ++frame) {
    const Eigen::Isometry3d T_world_sensor =
        street.pose(frame) * worldFromFirstCamera().inverse(); // the axes of a laser
    addCloud(scan(street, T_world_sensor), T_world_sensor, map);
  }
  const VoxelCloud voxels = map.occupiedEverywhere();
  std::cout << voxels.size() << " voxels\n";
  if (argc > 2)
    writeVoxelCloud(argv[2], voxels, map.labelSet(), VoxelColour::classes);
}
catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << "\n";
  return 1;
}
