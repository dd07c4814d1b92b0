// SPDX-License-Identifier: BSD-3-Clause

// 06: one map from two stereo cameras at different positions on a car.
//
// One looks forward, one to the left. Images, labels and poses are from the synthetic
// street. For cameras of your own, use one FrameSequence and LabelPredictor each.

#include "synthesize/sequence.h"

#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <iostream>

using namespace pcl_semantic;

namespace {

// Each camera casts its rays from its own position, so two clouds are two scans. Never
// join them into one: all of its rays would start at one camera.
void
addFrame(const SyntheticSequence& camera, std::size_t i, SemanticVoxelMap& map)
{
  const StereoFrame frame = camera.frame(i);
  const DisparityImage disparity =
      makeDisparityEstimator("sgm", 128)->estimate(frame.left, frame.right);
  const auto cloud = disparityToCloud(disparity.disparity, frame.left, camera.camera());
  map.integrate(*cloud, camera.pose(i), camera.labels(i)); // T_world_camera
}

// The pose of a camera is the car's pose times the camera's pose on the car:
// T_world_rig * T_rig_camera.
Eigen::Isometry3d
leftward()
{
  Eigen::Isometry3d T_rig_camera = Eigen::Isometry3d::Identity();
  T_rig_camera.translation() << -0.5, 0.0, -1.0; // half a metre left, a metre behind
  T_rig_camera.rotate(Eigen::AngleAxisd(-M_PI / 2.0, Eigen::Vector3d::UnitY()));
  return T_rig_camera; // camera axes: x right, y down, z forward
}

// Counts occupied voxels outside the view of a forward camera.
std::size_t
countBeside(const VoxelCloud& voxels)
{
  std::size_t beside = 0;
  for (const pcl::PointXYZRGBL& voxel : *voxels.cloud)
    beside += voxel.x < 2.0f && voxel.y > 3.0f;
  return beside;
}

void
print(const char* what, const SemanticVoxelMap& map)
{
  const VoxelCloud voxels = map.occupied();
  std::cout << what << ": " << voxels.size() << " voxels, " << countBeside(voxels)
            << " of them beside the car\n";
}

} // namespace

int
main(int, char** argv)
try {
  const LabelSet classes = readLabelSet(findDataFile("label_sets/kitti11.yaml"));
  const SyntheticSequence front(3, 310, 94), left(3, 310, 94, leftward());
  SemanticVoxelMap::Parameters parameters;
  parameters.voxel_size = 0.2;
  SemanticVoxelMap map(classes, parameters);
  for (std::size_t i = 0; i < front.size(); ++i) {
    addFrame(front, i, map);
    if (i == 0)
      print("one frame of the front camera", map);
    addFrame(left, i, map); // only one thread may write
  }
  print("all of both", map);
}
catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << "\n";
  return 1;
}
