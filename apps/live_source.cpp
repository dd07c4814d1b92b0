// SPDX-License-Identifier: BSD-3-Clause
#include "live_source.h"
#include "files/is_there.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/capture/live_capture.h>
#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/live_folder.h>
#include <pcl_semantic/dataset/live_rgbd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>

namespace pcl_semantic::tool {

namespace {

// Waits until another program has begun to fill the folder.
template <typename HoldsFrame>
void
waitFor(const std::string& what, HoldsFrame&& holdsFrame)
{
  StatusLine status("live");
  if (!holdsFrame())
    status.show("waiting for " + what);
  constexpr std::chrono::seconds patience(5);
  const auto begin = std::chrono::steady_clock::now();
  bool has_warned = false;
  while (!holdsFrame()) {
    if (interrupted())
      throw Exit{exit_interrupted};
    if (!has_warned && std::chrono::steady_clock::now() - begin > patience) {
      warn("still waiting for " + what + ", with names like 000000.png");
      has_warned = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

void
requireFolder(const std::string& folder, const std::string& layout)
{
  if (!isFolder(folder))
    fail<BadInputException>(folder, ": is no folder, expected one ", layout,
                            " that another program fills");
}

std::unique_ptr<LiveCamera>
openCamera(const MapInputs& inputs)
{
  const SequenceFiles& files = inputs.sequence;
  if (const std::string& folder = inputs.rgbd.folder; !folder.empty()) {
    requireFolder(folder, "with rgb and depth");
    waitFor("the first pair of images in rgb and depth of " + folder,
            [&] { return holdsRgbdFrame(folder); });
    return openLiveRgbd(inputs.rgbd, files.files.calibration);
  }
  if (files.hasFiles())
    return openCaptures(files.files);
  requireFolder(files.folder, "in KITTI's layout");
  waitFor("calib.txt and the first pair of images in " + files.folder,
          [&] { return holdsPair(files.folder); });
  return openLiveFolder(files.folder);
}

} // namespace

LiveSource::LiveSource(const MapInputs& inputs)
    : files_(inputs.sequence), name_(inputs.name())
{
  // Frames that arrive before the mapper is ready are dropped.
  std::unique_ptr<LiveCamera> camera = openCamera(inputs);
  warnOf(camera->doubts());
  warnOf(doubtsOf(camera->camera(), files_.strict));
  sensor_ = {camera->camera(), camera->T_camera0_camera(), camera->hasDepth()};
  grabber_ = std::make_unique<FrameGrabber>(std::move(camera));
}

std::optional<SensorFrame>
LiveSource::next()
{
  constexpr std::chrono::milliseconds patience(100); // to react to an interrupt
  while (!interrupted() && !grabber_->hasEnded())
    try {
      std::optional<FrameGrabber::Grabbed> grabbed = grabber_->take(patience);
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
    warn(name_ + ": delivers no more images");
  return std::nullopt;
}

double
LiveSource::secondsSinceGrabbed() const
{
  return std::chrono::duration<double>(FrameGrabber::Clock::now() - grabbed_).count();
}

} // namespace pcl_semantic::tool
