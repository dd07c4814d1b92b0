// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/camera_doubts.h>

#include "fail.h"
#include "text_stream.h"

#include <cmath>

namespace pcl_semantic {

std::vector<std::string>
doubtsOf(const StereoCamera& camera)
{
  if (camera.width <= 0 || camera.height <= 0)
    return {};
  std::vector<std::string> doubts;
  const double x = camera.cx / camera.width, y = camera.cy / camera.height;
  if (!(std::abs(x - 0.5) < 0.2 && std::abs(y - 0.5) < 0.3)) {
    TextStream text;
    text << "the principal point (" << camera.cx << ", " << camera.cy
         << ") is far from the middle of the images, " << camera.width << " x "
         << camera.height << ": is the calibration of images of another size?";
    doubts.push_back(text.str());
  }
  // A field of view of 170 degrees, too wide for a pinhole camera.
  if (camera.fx < 0.04 * camera.width) {
    TextStream text;
    text << "the focal length, " << camera.fx << ", is short for images of "
         << camera.width << " pixels: is it in pixels?";
    doubts.push_back(text.str());
  }
  return doubts;
}

std::vector<std::string>
doubtsOf(const StereoCamera& camera, bool strict)
{
  std::vector<std::string> doubts = doubtsOf(camera);
  if (strict && !doubts.empty())
    badInput(doubts.front());
  return doubts;
}

} // namespace pcl_semantic
