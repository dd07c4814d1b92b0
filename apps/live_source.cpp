// SPDX-License-Identifier: BSD-3-Clause
#include "live_source.h"
#include "files/is_there.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/capture/live_capture.h>
#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/live_folder.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>

namespace pcl_semantic::tool {

namespace {

std::unique_ptr<LiveCamera>
openCamera(const SequenceFiles& options)
{
  if (options.hasFiles())
    return openCaptures(options.files);
  if (!isFolder(options.folder))
    fail<BadInputException>(options.folder, ": is no folder, expected one in KITTI's "
                                            "layout that another program fills");
  StatusLine status("live");
  if (!holdsPair(options.folder))
    status.show("waiting for calib.txt and the first pair of images in " +
                options.folder);
  while (!holdsPair(options.folder)) {
    if (interrupted())
      throw Exit{exit_interrupted};
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return openLiveFolder(options.folder);
}

} // namespace

LiveSource::LiveSource(const SequenceFiles& files) : files_(files)
{
  // Pairs that arrive before the mapper is ready are dropped.
  std::unique_ptr<LiveCamera> camera = openCamera(files);
  warnOf(camera->doubts());
  warnOf(doubtsOf(camera->camera(), files.strict));
  sensor_ = {camera->camera(), camera->T_camera0_camera()};
  grabber_ = std::make_unique<StereoGrabber>(std::move(camera));
}

std::optional<SensorFrame>
LiveSource::next()
{
  constexpr std::chrono::milliseconds patience(100); // to react to an interrupt
  while (!interrupted() && !grabber_->hasEnded())
    try {
      std::optional<StereoGrabber::Grabbed> grabbed = grabber_->take(patience);
      if (!grabbed)
        continue;
      grabbed_ = grabbed->when;
      return std::move(grabbed->frame);
    }
    catch (const BadInputException& error) {
      if (files_.strict || grabber_->hasEnded())
        throw; // no more can arrive
      if (++damaged_ == 1)
        warn(std::string(error.what()) + "; the frame is ignored");
    }
  if (!interrupted() && !isVideo(files_.files.left))
    warn(files_.name() + ": delivers no more images");
  return std::nullopt;
}

double
LiveSource::secondsSinceGrabbed() const
{
  return std::chrono::duration<double>(StereoGrabber::Clock::now() - grabbed_).count();
}

} // namespace pcl_semantic::tool
