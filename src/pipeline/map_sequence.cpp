// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/map_sequence.h>

#include <pcl_semantic/dataset/frame_sequence.h>
#include <pcl_semantic/odometry/stereo_odometry.h>
#include <pcl_semantic/odometry/trajectory_poses.h>

namespace pcl_semantic {

namespace {

std::unique_ptr<PoseSource>
openPoses(const FrameSequence& sequence, std::vector<std::string>* doubts)
{
  const std::string path = sequence.posesPath();
  if (path.empty())
    return std::make_unique<StereoOdometry>(sequence.camera(),
                                            sequence.T_camera0_camera());
  return readPoses(path, sequence.T_camera0_camera(), doubts);
}

} // namespace

VoxelCloud
mapSequence(const FrameSequence& sequence, const LabelSet& label_set,
            std::unique_ptr<LabelPredictor> predictor, const MapperConfig& config,
            std::vector<std::string>* doubts)
{
  std::unique_ptr<PoseSource> poses = openPoses(sequence, doubts);
  poses->requirePoses(frameTimes(sequence, selectFrames(sequence, FrameRange())));
  SemanticMapper mapper(label_set, config, std::move(poses), sequence.camera(),
                        std::move(predictor));
  for (std::size_t i = 0; i < sequence.size(); ++i)
    mapper.process(sequence.frame(i));
  mapper.finish();
  return mapper.map().occupiedEverywhere();
}

} // namespace pcl_semantic
