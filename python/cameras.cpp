// SPDX-License-Identifier: BSD-3-Clause
#include "cameras.h"

#include <pcl_semantic/core/camera_doubts.h>
#include <pcl_semantic/dataset/pinhole_camera.h>

namespace pcl_semantic::python {

void
warnOf(const std::vector<std::string>& doubts)
{
  for (const std::string& doubt : doubts)
    warn(doubt);
}

void
bindCameras(py::module_& module)
{
  module.def(
      "read_camera",
      [](const Path& path) {
        const PinholeCamera camera = released([&] { return readPinholeCamera(path); });
        warnOf(camera.doubts);
        for (const std::string& doubt :
             doubtsOf(StereoCamera{camera.fx, camera.fy, camera.cx, camera.cy, 1.0,
                                   camera.width, camera.height}))
          warn(path.text + ": " + doubt);
        py::dict read;
        read["fx"] = camera.fx;
        read["fy"] = camera.fy;
        read["cx"] = camera.cx;
        read["cy"] = camera.cy;
        read["width"] = camera.width;
        read["height"] = camera.height;
        return read;
      },
      py::arg("path"),
      "The camera of undistorted images: fx, fy, cx, cy, width and height [px] (0 if "
      "the\n"
      "file states none), of ROS' camera_info, OpenCV's camera_matrix, Kalibr's "
      "camchain or\n"
      "EuRoC's sensor.yaml (.yaml), KITTI's or Middlebury's calib.txt. Binning and a "
      "region\n"
      "of interest are applied; P of rectified images takes the place of K.");
}

} // namespace pcl_semantic::python
