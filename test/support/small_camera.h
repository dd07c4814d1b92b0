// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/stereo_camera.h>

namespace pcl_semantic {

/** \brief A camera of few pixels, not square, its centre off the middle. */
inline StereoCamera
smallCamera()
{
  StereoCamera camera;
  camera.fx = 60.0;
  camera.fy = 50.0;
  camera.cx = 40.2;
  camera.cy = 25.3;
  camera.baseline = 0.5;
  camera.width = 80;
  camera.height = 50;
  return camera;
}

} // namespace pcl_semantic
