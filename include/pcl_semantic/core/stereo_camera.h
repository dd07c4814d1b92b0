// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/abi_check.h>
#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A rectified stereo pair of pinhole cameras.
 *
 * Camera frame of the left image: x right, y down, z forward. Pixel centres lie at
 * integer coordinates, the centre of the first pixel is (0, 0). */
struct StereoCamera {
  double fx = 0.0;       ///< focal length in x [px]
  double fy = 0.0;       ///< focal length in y [px]
  double cx = 0.0;       ///< principal point, column [px]
  double cy = 0.0;       ///< principal point, row [px]
  double baseline = 0.0; ///< distance of the right camera along +x [m]
  int width = 0;         ///< columns of an image [px]; 0 = unknown
  int height = 0;        ///< rows of an image [px]; 0 = unknown

  /** \throws InvalidParameterException unless focal lengths and baseline are positive
   * and all values are finite */
  void validate() const;

  /** \brief Depth of a disparity: Z = f b / d [m]. */
  double
  depth(double disparity) const
  {
    return fx * baseline / disparity;
  }

  /** \brief Standard deviation of a depth divided by its square [1/m], for a disparity
   * with a standard deviation of 0.125 px; see SemanticVoxelMap::setDepthError(). */
  double
  depthError() const
  {
    return 0.125 / (fx * baseline);
  }

  /** \brief Point in the left camera's frame [m] of a pixel at a depth [m]. */
  Eigen::Vector3d
  unproject(double u, double v, double depth) const
  {
    return {(u - cx) / fx * depth, (v - cy) / fy * depth, depth};
  }

  /** \brief Pixel (column, row) of a point in the left camera's frame with z > 0. */
  Eigen::Vector2d
  project(const Eigen::Vector3d& point) const
  {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
};

} // namespace pcl_semantic
