// SPDX-License-Identifier: BSD-3-Clause
#include "live_frames.h"
#include "view_of_map.h"

#include <pcl_semantic/core/exceptions.h>

#include <cmath>
#include <iostream>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace pcl_semantic::tool {

// What the reading thread and the window have in common.
struct LiveShow::Inbox {
  std::mutex mutex;
  std::optional<ViewedMap> newest;
  std::thread reader;
};

LiveShow::LiveShow(const ViewArguments& arguments, MapViewer& viewer)
    : arguments_(arguments), viewer_(viewer), inbox_(std::make_shared<Inbox>())
{
  viewer.state().pictures = true;
}

LiveShow::~LiveShow()
{
  if (!inbox_->reader.joinable())
    return;
  // The reader may wait for a frame; only a socket can be told to give up.
  if (shutdown(STDIN_FILENO, SHUT_RDWR) == 0)
    inbox_->reader.join();
  else
    inbox_->reader.detach();
}

void
LiveShow::sayReady()
{
  std::cout << "ready" << std::endl;
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  close(nowhere);
  inbox_->reader = std::thread([inbox = inbox_] {
    try {
      while (std::optional<ViewedMap> map = readViewedMap(stdin)) {
        const std::lock_guard<std::mutex> lock(inbox->mutex);
        inbox->newest = std::move(map);
      }
    }
    catch (const BadInputException&) {
      // Who sends was killed: what has come stays on the screen.
    }
  });
}

void
LiveShow::showNewest()
{
  std::optional<ViewedMap> newest;
  {
    const std::lock_guard<std::mutex> lock(inbox_->mutex);
    newest.swap(inbox_->newest);
  }
  if (newest)
    show(std::move(*newest));
}

void
LiveShow::showLast()
{
  std::optional<ViewedMap> last;
  while (std::optional<ViewedMap> map = readViewedMap(stdin))
    last = std::move(map);
  if (!last)
    PCL_THROW_EXCEPTION(BadInputException, "standard input: has no map");
  show(std::move(*last));
}

void
LiveShow::show(ViewedMap map)
{
  if (map.indices.empty())
    return; // nothing to look at yet
  std::vector<PictureView> views = viewsOf(map);
  if (!map.path.empty()) {
    const Eigen::Vector3d place = map.path.back().translation();
    if (!is_first_) // it comes along
      viewer_.move(place - last_place_);
    last_place_ = place;
  }
  viewer_.show(std::move(map), std::move(views));
  if (is_first_)
    for (const std::string& key : arguments_.keys)
      viewer_.press(key);
  is_first_ = false;
}

// From behind the camera, and the map as a whole.
std::vector<PictureView>
LiveShow::viewsOf(const ViewedMap& map) const
{
  const cv::Size size = arguments_.picture.size;
  VoxelScene scene;
  scene.grid = map.grid;
  scene.voxels.indices = map.indices;
  SensorPath path = pathOf(map.path);
  for (Eigen::Vector3d& place : path)
    place -= map.grid.corner;
  std::vector<PictureView> views;
  if (!map.path.empty()) {
    const Eigen::Isometry3d& pose = map.path.back();
    const Eigen::Vector3d behind = pose * Eigen::Vector3d(0.0, -6.0, -10.0),
                          ahead = pose * Eigen::Vector3d(0.0, 1.0, 12.0);
    views.push_back(lookAt(behind - map.grid.corner, ahead - map.grid.corner,
                           60.0 * M_PI / 180.0, size));
  }
  views.push_back(angleView(scene, path, size));
  views.push_back(aboveView(scene, path, size));
  return views;
}

} // namespace pcl_semantic::tool
