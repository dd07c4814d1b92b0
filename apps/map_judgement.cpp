// SPDX-License-Identifier: BSD-3-Clause
#include "map_judgement.h"
#include "messages.h"
#include "tool.h"

#include <pcl_semantic/core/exceptions.h>

#include <cmath>

namespace pcl_semantic::tool {

void
judgeTracking(const std::string& sequence, int lost, int frames)
{
  if (lost == 0)
    return;
  if (lost + 1 == frames)
    fail<BadInputException>(sequence, ": no frame could be tracked");
  warn(std::to_string(lost) +
       " frames could not be tracked: their poses are predicted");
}

void
judgeCalibration(const std::string& calibration, double domain_shift)
{
  constexpr double usual = 1.0;
  if (domain_shift > usual)
    warn(calibration + ": was learned from other streets than this one (domain shift " +
         shown(domain_shift) +
         ", expected at most 1): compare the map with one without it");
}

void
warnOfEmptyMap()
{
  warn("the map is empty: no point lies within --max-depth of the sensor "
       "(coordinates are metres, in the sensor's frame)");
}

void
PoseWatch::look(int frame, const Eigen::Vector3d& position)
{
  const double distance = last_ ? (position - *last_).norm() : 0.0;
  last_ = position;
  if (has_warned_ || !(distance > farthest_))
    return;
  has_warned_ = true;
  warn("frame " + std::to_string(frame) + " is " + shown(std::round(distance)) +
       " m from the one before it: are its poses those of these frames, in metres?");
}

} // namespace pcl_semantic::tool
