// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A pinhole camera without distortion: fx, fy, cx, cy [px]. */
struct PinholeCamera {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;

  /** \throws InvalidParameterException unless focal lengths are positive and all is
   * finite */
  void validate() const;
};

/** \brief Reads the intrinsics of a camera: ROS' camera_info as YAML (`K` or
 * `camera_matrix: data`), or the first camera of Kalibr's camchain (`cam0:
 * intrinsics`). Images have to be undistorted: distortion in the file is refused.
 * \throws BadInputException with file and line */
PinholeCamera readPinholeCamera(const std::string& path);

} // namespace pcl_semantic
