// SPDX-License-Identifier: BSD-3-Clause
#include "pair_watch.h"
#include "messages.h"

#include <pcl_semantic/core/exceptions.h>

#include <cmath>
#include <sstream>

namespace pcl_semantic::tool {

PairWatch::PairWatch(bool strict, const StereoCamera& camera) : strict_(strict)
{
  // Of images of half or double the size it is far off.
  const double x = camera.cx / camera.width, y = camera.cy / camera.height;
  if (std::abs(x - 0.5) < 0.2 && std::abs(y - 0.5) < 0.3)
    return;
  std::ostringstream text;
  text << "the principal point (" << camera.cx << ", " << camera.cy
       << ") is far from the middle of the images, " << camera.width << " x "
       << camera.height << ": is the calibration of images of another size?";
  if (strict_)
    PCL_THROW_EXCEPTION(BadInputException, text.str());
  warn(text.str());
}

PairWatch::~PairWatch()
{
  for (const auto& [fault, pairs] : warned_)
    if (pairs > 1)
      warn(std::to_string(pairs) + " pairs looked " +
           (fault == PairFault::blank       ? "blank"
            : fault == PairFault::identical ? "identical"
            : fault == PairFault::swapped   ? "swapped"
                                            : "unrelated"));
}

void
PairWatch::look(const StereoFrame& frame, const std::string& name)
{
  const PairFault fault = check_.add(frame.left, frame.right);
  if (fault == PairFault::none)
    return;
  if (strict_)
    PCL_THROW_EXCEPTION(BadInputException, name << ": " << check_.reason());
  if (++warned_[fault] == 1)
    warn(name + ": " + check_.reason());
}

} // namespace pcl_semantic::tool
