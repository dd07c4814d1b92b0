// SPDX-License-Identifier: BSD-3-Clause
#include "map_watch.h"
#include "tool.h"

#include <cmath>
#include <string>

namespace pcl_semantic::tool {

bool
MapWatch::isInterrupted()
{
  return interrupted();
}

void
MapWatch::onFrame(const SensorFrame& frame)
{
  if (const auto* const pair = std::get_if<StereoFrame>(&frame))
    pairs_.look(*pair);
  else if (const auto* const rgbd = std::get_if<RgbdFrame>(&frame)) {
    dark_.look(rgbd->image, "frame " + std::to_string(rgbd->number));
    unmeasured_ += rgbd->unmeasured;
  }
  else
    look(std::get<CloudFrame>(frame));
}

void
MapWatch::onMapped(const SensorFrame& frame, const MappedFrame& mapped)
{
  if (const auto* const cloud = std::get_if<CloudFrame>(&frame))
    lookAtViewpoint(*cloud, mapped.T_world_camera);
  std::string text = "frame " + std::to_string(mapped.frame.number);
  for (const auto& [stage, seconds] : mapped.times.seconds())
    text += ", " + stage + " " + std::to_string(std::lround(1e3 * seconds)) + " ms";
  note(text + ", " + std::to_string(mapped.voxels.size()) + " voxels");
}

void
MapWatch::onDoubt(const std::string& doubt)
{
  warnOf({doubt});
}

void
MapWatch::onNote(const std::string& text)
{
  note(text);
}

void
MapWatch::look(const CloudFrame& frame)
{
  if (!told_of_doubts_)
    warnOf(frame.doubts);
  told_of_doubts_ = told_of_doubts_ || !frame.doubts.empty();
  if (told_of_labels_ || !frame.distributions.empty() || frame.cloud->empty())
    return;
  warn(frame.path +
       ": has no field 'label' or 'probability': it gives the map no labels");
  told_of_labels_ = true;
}

// Warns of an unused VIEWPOINT, which may be the intended pose of the cloud.
void
MapWatch::lookAtViewpoint(const CloudFrame& frame, const Eigen::Isometry3d& used)
{
  const bool is_default = // in most files
      frame.viewpoint.matrix() == Eigen::Matrix4d::Identity();
  default_viewpoints_ += is_default;
  if (poses_ == "viewpoint" && is_default && default_viewpoints_ == 2)
    warn(frame.path + ": the VIEWPOINT of a second cloud is the default, 0 0 0 1 0 0 "
                      "0: do the files state poses?");
  if (told_of_viewpoint_ || is_default || poses_ == "viewpoint" ||
      !frame.viewpoint.matrix().allFinite() || frame.viewpoint.isApprox(used, 1e-3))
    return;
  TextStream text;
  text << frame.path << ": its VIEWPOINT, at "
       << frame.viewpoint.translation().transpose() << ", is not used, its pose of "
       << poses_ << " is at " << used.translation().transpose()
       << " (--poses viewpoint uses it)";
  warn(text.str());
  told_of_viewpoint_ = true;
}

} // namespace pcl_semantic::tool
