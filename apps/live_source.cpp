// SPDX-License-Identifier: BSD-3-Clause
#include "live_source.h"
#include "files/is_there.h"
#include "map_labelling.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/capture/live_capture.h>
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/live_folder.h>
#include <pcl_semantic/odometry/stereo_odometry.h>
#include <pcl_semantic/odometry/trajectory_poses.h>
#include <pcl_semantic/pipeline/late_labels.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>

namespace pcl_semantic::tool {

namespace {

std::unique_ptr<LiveCamera>
openCamera(const SequenceOptions& options)
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

LiveSource::LiveSource(const MapArguments& arguments) : MapSource(arguments)
{
  MapLabelling labelling = makeLabelling(arguments);
  setInputs({{"live", "true"},
             {"poses", arguments.poses == "auto" ? "odometry" : arguments.poses},
             {"labels", arguments.labels},
             {"label_mapping", arguments.label_mapping},
             {"network", arguments.network},
             {"model", labelling.model},
             {"engine", labelling.engine}});
  run_.label_set = labelling.label_set;
  labels_ = std::move(labelling.predictor);
  watch_of_mapping_ = std::move(labelling.watch);
  predictor_ = std::make_unique<NoLabels>();
  extras_.images = false;
  extras_.centres = arguments.centres;
  readCalibrations();
  if (arguments.poses != "auto" && arguments.poses != "odometry") {
    trajectory_ = readTrajectory(arguments.poses, PoseFrame::first_camera);
    warnOf(trajectory_->doubts); // before it waits
  }
  // Last: what comes until the mapper is made is dropped.
  std::unique_ptr<LiveCamera> camera = openCamera(arguments.sequence);
  warnOf(camera->doubts());
  watch_.emplace(arguments.sequence.strict, camera->camera());
  run_.camera = camera->camera();
  run_.T_camera0_camera = camera->T_camera0_camera();
  grabber_ = std::make_unique<StereoGrabber>(std::move(camera));
}

std::unique_ptr<PoseSource>
LiveSource::openPoses(std::vector<std::string>&) const
{
  if (!trajectory_)
    return std::make_unique<StereoOdometry>(*run_.camera, run_.T_camera0_camera);
  return posesOf(*trajectory_, run_.T_camera0_camera);
}

std::optional<SensorFrame>
LiveSource::next()
{
  constexpr std::chrono::milliseconds patience(100); // with an interrupt
  while (!interrupted() && !grabber_->hasEnded())
    try {
      std::optional<StereoGrabber::Grabbed> grabbed = grabber_->take(patience);
      if (!grabbed)
        continue;
      watch_->look(grabbed->frame);
      grabbed_ = grabbed->when;
      return std::move(grabbed->frame);
    }
    catch (const BadInputException& error) {
      if (arguments_.sequence.strict || grabber_->hasEnded())
        throw; // no more can come
      if (++damaged_ == 1)
        warn(std::string(error.what()) + "; it is left out");
    }
  if (!interrupted() && !isVideo(arguments_.sequence.files.left))
    warn(arguments_.sequence.name() + ": gives no more images");
  return std::nullopt;
}

double
LiveSource::secondsSinceGrabbed() const
{
  return std::chrono::duration<double>(StereoGrabber::Clock::now() - grabbed_).count();
}

} // namespace pcl_semantic::tool
