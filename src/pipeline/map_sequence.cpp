// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pipeline/map_sequence.h>

#include <pcl_semantic/pipeline/map_run.h>
#include <pcl_semantic/things/plane_summary.h>

#include <utility>

namespace pcl_semantic {

VoxelCloud
mapSequence(const FrameSequence& sequence, const LabelSet& label_set,
            std::unique_ptr<LabelPredictor> predictor, const MapperConfig& config,
            std::vector<std::string>* doubts)
{
  OpenedInputs inputs;
  const auto borrowed = std::shared_ptr<const FrameSequence>(
      std::shared_ptr<void>(), &sequence); // owned by the caller
  inputs.source = std::make_unique<RecordedFrames>(borrowed, FrameRange());
  openPoses(sequence.posesPath(), inputs);
  if (doubts)
    doubts->insert(doubts->end(), inputs.doubts.begin(), inputs.doubts.end());
  inputs.label_set = label_set;
  inputs.predictor = std::move(predictor);
  MapRun run(std::move(inputs), config);
  run.run();
  VoxelCloud voxels = run.map().occupiedEverywhere();
  if (run.objects())
    voxels.objects = run.objects()->numbers(voxels);
  if (config.things)
    voxels.planes = findPlanes(voxels.cloud, voxels.voxel_size, voxels.origin).numbers;
  return voxels;
}

} // namespace pcl_semantic
