// SPDX-License-Identifier: BSD-3-Clause
#include "map_source.h"

#include "map_extras.h"
#include "map_poses.h"
#include "pair_watch.h"

#include <pcl_semantic/dataset/frame_range.h>

namespace pcl_semantic::tool {

namespace {

class SequenceSource : public MapSource {
public:
  explicit SequenceSource(const MapArguments& arguments)
      : arguments_(arguments), sequence_(openSequence(arguments.sequence)),
        watch_("pcl_semantic_map", arguments.sequence.strict)
  {
    poses_ = choosePoses(arguments, *sequence_);
    labelling_ = makeLabelling(arguments);
    positions_ = chooseFrames(arguments.sequence, *sequence_, arguments.frames);
    run_.inputs = inputsOf(arguments.sequence);
    run_.inputs.insert(run_.inputs.end(),
                       {{"poses", poses_},
                        {"labels", arguments.labels},
                        {"network", arguments.network},
                        {"model", labelling_.model},
                        {"label_calibration", arguments.label_calibration},
                        {"clique_calibration", arguments.clique_calibration}});
    for (const std::size_t i : positions_)
      run_.frames.push_back(sequence_->frameNumber(i));
    run_.camera = sequence_->camera();
    run_.T_camera0_camera = sequence_->T_camera0_camera();
    run_.label_set = labelling_.label_set;
    run_.config = arguments.parameters;
    extras_ = makeExtras(arguments, sequence_.get(), positions_);
    calibrations_ = readCalibrations(arguments, run_.label_set);
  }

  std::vector<FrameTime>
  times() const override
  {
    return frameTimes(*sequence_, positions_);
  }

  std::unique_ptr<PoseSource>
  openPoses() const override
  {
    return makePoses(poses_, *sequence_);
  }

  MappedFrame
  map(std::size_t i, SemanticMapper& mapper) override
  {
    const StereoFrame pair = sequence_->frame(positions_[i]);
    watch_.look(pair);
    return mapper.process(pair);
  }

private:
  std::unique_ptr<SemanticMapper>
  newMapper(std::unique_ptr<PoseSource> poses,
            std::shared_ptr<BlockStore> store) override
  {
    return std::make_unique<SemanticMapper>(run_.camera, run_.label_set, run_.config,
                                            std::move(labelling_.predictor),
                                            std::move(poses), std::move(store));
  }

  MapArguments arguments_;
  std::unique_ptr<FrameSequence> sequence_;
  PairWatch watch_;
  Labelling labelling_;
  std::vector<std::size_t> positions_;
};

} // namespace

std::unique_ptr<SemanticMapper>
MapSource::makeMapper(std::unique_ptr<PoseSource> poses,
                      std::shared_ptr<BlockStore> store)
{
  auto mapper = newMapper(std::move(poses), std::move(store));
  setCalibrations(calibrations_, *mapper);
  return mapper;
}

std::unique_ptr<MapSource>
openMapSource(const MapArguments& arguments)
{
  if (!arguments.clouds.empty())
    return openCloudSource(arguments);
  return std::make_unique<SequenceSource>(arguments);
}

} // namespace pcl_semantic::tool
