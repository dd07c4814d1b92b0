// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/files/label_set_file.h>
#include <pcl_semantic/labelling/network_predictor.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/semantic_mapper.h>

#include <cstdlib>
#include <memory>
#include <string>

namespace pcl_semantic {

/** \brief Folder of real data; empty if not set. */
inline std::string
realDataFolder()
{
  const char* const folder = std::getenv("PCL_SEMANTIC_DATA");
  return folder ? folder : "";
}

/** \brief Description of the largest network in realDataFolder(). */
inline NetworkDescription
kittiNetworkDescription()
{
  return readNetworkDescription(PCL_SEMANTIC_SOURCE_DIR
                                "/data/networks/espnetv2_city_1280x480.yaml");
}

/** \brief The network of kittiNetworkDescription(), with the classes of its
 * description. */
inline std::unique_ptr<NetworkPredictor>
kittiNetwork()
{
  const NetworkDescription network = kittiNetworkDescription();
  return std::make_unique<NetworkPredictor>(
      network, readLabelSet(network.label_set_path),
      realDataFolder() + "/nets/espnetv2_s2.0_city_1280x480_halfres.onnx");
}

/** \brief Fused voxels of all frames of KITTI 15 with depths up to \a max_depth [m],
 * without a CRF. Their points are the centres, as for a mapper's CRF
 * (SemanticCRF::setVoxels). */
inline VoxelCloud
makeKittiMap(double max_depth)
{
  const KittiSequence sequence(realDataFolder() + "/kitti/15");
  MapperConfig config;
  config.crf = CRFModelType::unary;
  config.map.max_range = max_depth;
  config.map.fusion.miss_probability = 0.499; // keeps all hit voxels occupied
  SemanticMapper mapper(readLabelSet(kittiNetworkDescription().label_set_path), config,
                        readPoses(sequence.posesPath(), sequence.T_camera0_camera()),
                        sequence.camera(), kittiNetwork());
  for (std::size_t i = 0; i < sequence.size(); ++i)
    mapper.process(sequence.frame(i));
  VoxelCloud voxels = mapper.map().occupied();
  voxels.moveToCentres();
  return voxels;
}

} // namespace pcl_semantic
