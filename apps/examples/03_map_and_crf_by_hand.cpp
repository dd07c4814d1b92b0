// SPDX-License-Identifier: BSD-3-Clause

// 03: the steps of 01 by hand. Each can be omitted, inspected or replaced.
//
//   03_map_and_crf_by_hand               maps four frames of a synthetic street
//   03_map_and_crf_by_hand SEQUENCE      a folder in KITTI's layout with poses
//                                        and labels/

#include "synthesize/sequence.h"

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/data_folder.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/filters/semantic_crf.h>
#include <pcl_semantic/labelling/stored_predictor.h>
#include <pcl_semantic/map/seen_through.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <iostream>

using namespace pcl_semantic;

namespace {

// Adds a frame to the map: images -> disparities -> points -> voxels.
void
addFrame(const StereoFrame& frame, const StereoCamera& camera,
         const LabelDistributions& labels, const Eigen::Isometry3d& T_world_camera,
         SemanticVoxelMap& map)
{
  const auto stereo = makeDisparityEstimator("sgm", 128);
  const DisparityImage disparity = stereo->estimate(frame.left, frame.right);
  const auto cloud = disparityToCloud(disparity.disparity, frame.left, camera);
  eraseSeenThrough(*cloud, camera, T_world_camera, map.parameters().voxel_size, 0.33);
  map.setDepthError(camera.depthError());
  const ScanCounts counts = map.integrate(*cloud, T_world_camera, labels);
  std::cout << "frame " << frame.number << ": " << counts.rays << " rays hit "
            << counts.hit_voxels << " voxels\n";
}

// Refines the map: voxels as a cloud -> CRF -> map. Returns the number of changed
// labels.
std::size_t
refine(SemanticVoxelMap& map)
{
  const VoxelCloud voxels = map.occupied();
  SemanticCRF<pcl::PointXYZRGBL> crf;
  crf.setInputCloud(voxels.cloud);
  crf.setVoxels(voxels.indices, voxels.voxel_size); // exact positions
  crf.setLabelDistributions(voxels.measured);       // not an earlier result
  pcl::PointCloud<pcl::PointXYZRGBL> refined;
  crf.filter(refined);
  map.setRefined(voxels, crf.getLabelDistributions());

  std::size_t changed = 0;
  for (Eigen::Index i = 0; i < voxels.measured.size(); ++i)
    changed += refined[std::size_t(i)].label != voxels.measured.mapLabel(i);
  return changed;
}

} // namespace

int
main(int argc, char** argv)
try {
  const LabelSet classes = readLabelSet(findDataFile("label_sets/kitti11.yaml"));
  SemanticVoxelMap map(classes, SemanticVoxelMap::Parameters());
  if (argc > 1) {
    const std::string folder = argv[1];
    const KittiSequence sequence(folder);
    StoredPredictor labels(folder + "/labels", classes.size(), 0.8f);
    const auto poses = readPoses(folder + "/poses.txt", sequence.T_camera0_camera());
    for (std::size_t i = 0; i < sequence.size(); ++i) {
      const StereoFrame frame = sequence.frame(i);
      addFrame(frame, sequence.camera(), labels.predict(frame.left, frame.number),
               poses->pose(frame), map);
    }
  }
  else {
    const SyntheticSequence street(4, 310, 94);
    for (std::size_t i = 0; i < street.size(); ++i)
      addFrame(street.frame(i), street.camera(), street.labels(i), street.pose(i), map);
  }
  const std::size_t changed = refine(map);
  std::cout << map.occupied().size() << " voxels, the CRF changed " << changed << "\n";
}
catch (const std::exception& error) {
  std::cerr << argv[0] << ": " << error.what() << "\n";
  return 1;
}
