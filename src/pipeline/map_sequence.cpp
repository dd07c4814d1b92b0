// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/map_sequence.h>

#include <pcl_semantic/odometry/stereo_odometry.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/map_run.h>

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
  OpenedInputs inputs;
  inputs.poses = openPoses(sequence, doubts);
  const auto borrowed = std::shared_ptr<const FrameSequence>(
      std::shared_ptr<void>(), &sequence); // owned by the caller
  inputs.source = std::make_unique<RecordedFrames>(borrowed, FrameRange());
  inputs.label_set = label_set;
  inputs.predictor = std::move(predictor);
  MapRun run(std::move(inputs), config);
  run.run();
  return run.map().occupiedEverywhere();
}

} // namespace pcl_semantic
