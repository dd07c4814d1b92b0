// SPDX-License-Identifier: BSD-3-Clause
#include "image_tool.h"
#include "live_mapping.h"
#include "map_arguments.h"
#include "messages.h"
#include "network_trial.h"
#include "recorded_mapping.h"
#include "tool.h"

#include <pcl_semantic/capture/live_capture.h>
#include <pcl_semantic/capture/video_pair_sequence.h>

#include <iostream>
#include <memory>

namespace {

using namespace pcl_semantic;
using namespace pcl_semantic::tool;

std::unique_ptr<FrameSequence>
openVideos(const ImagePairFiles& files)
{
  auto videos = std::make_unique<VideoPairSequence>(files);
  warnOf(videos->doubts());
  return videos;
}

int
mapEveryFrame(MapArguments arguments)
{
  const ImagePairFiles& files = arguments.sequence.files;
  refuseIf(!isVideo(files.left) || !isVideo(files.right),
           "--every-frame needs videos for --left and --right; pcl_semantic_map maps "
           "sequences of images");
  arguments.sequence.open_videos = openVideos;
  printResults(mapRecorded(arguments));
  return interrupted() ? exit_interrupted : exit_done;
}

void
requireCaptures(const SequenceOptions& sequence)
{
  const auto isLive = [](const std::string& name) {
    return isCapture(name) || isVideo(name);
  };
  refuseIf(sequence.hasFiles() &&
               !(isLive(sequence.files.left) && isLive(sequence.files.right)),
           "expected cameras, streams or videos for --left and --right, or a SEQUENCE");
}

} // namespace

int
main(int argc, char** argv)
{
  if (const auto trial = runAsNetworkTrial(argc, argv))
    return *trial;
  return runWithImages("pcl_semantic_live", [&] {
    keepFreedMemory();
    const MapArguments arguments = parseMapArguments(argc, argv, MapProgram::live);
    if (arguments.print_config) {
      std::cout << printMapperConfig(arguments.parameters);
      return int(exit_done);
    }
    if (arguments.every_frame)
      return mapEveryFrame(arguments);
    requireCaptures(arguments.sequence);
    restartWithShortSpins(argv);
    return mapLive(arguments);
  });
}
