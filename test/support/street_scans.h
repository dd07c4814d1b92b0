// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "synthesize/labels.h"
#include "synthesize/renderer.h"

#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <limits>

namespace pcl_semantic {

/** \brief A frame of the synthetic sequence, ready to integrate. */
struct StreetScan {
  pcl::PointCloud<pcl::PointXYZRGB>::Ptr cloud; ///< organized, camera frame [m]
  LabelDistributions distributions;             ///< L x pixels
  Eigen::Isometry3d T_world_camera;
};

/** \brief The first frames of the sequence, with ground truth disparity. */
inline std::vector<StreetScan>
makeStreetScans(int frames, int width, int height)
{
  const SyntheticRenderer street(SyntheticScene(1, frames), width, height);
  std::vector<StreetScan> scans;
  for (int i = 0; i < frames; ++i) {
    const SyntheticView view = street.render(i);
    scans.push_back({disparityToCloud(view.disparity, view.left, view.camera),
                     syntheticDistributions(view, 1), view.T_world_camera});
  }
  return scans;
}

/** \brief The occupied voxels of the map of these frames. */
inline VoxelCloud
makeStreetMap(int frames, int width = 620, int height = 188)
{
  SemanticVoxelMap map(readLabelSet(std::string(PCL_SEMANTIC_SOURCE_DIR) +
                                    "/data/label_sets/kitti11.yaml"),
                       SemanticVoxelMap::Parameters());
  for (const StreetScan& scan : makeStreetScans(frames, width, height))
    map.integrate(*scan.cloud, scan.T_world_camera, scan.distributions);
  return map.occupied();
}

} // namespace pcl_semantic
