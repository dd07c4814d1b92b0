// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/stereo_camera.h>

#include <Eigen/Core>

#include <cmath>

namespace pcl_semantic::synthetic {

/** \brief Lens of a synthetic camera. A fisheye shows a ray with the angle a to the
 * optical axis at f a pixels from the principal point: the equidistant model of Kannala
 * and Brandt with coefficients of 0. */
enum class Lens { pinhole, fisheye };

/** \brief Focal length of a lens in that of a pinhole camera with the same images. */
inline double
focalFactor(Lens lens)
{
  return lens == Lens::fisheye ? 0.7 : 1.0;
}

/** \brief The pixel of a pinhole camera with the same matrix that sees the ray of a
 * pixel of the lens. */
inline Eigen::Vector2d
pinholePixel(Lens lens, const StereoCamera& camera, double u, double v)
{
  const Eigen::Vector2d offset(u - camera.cx, v - camera.cy);
  const double angle = offset.norm() / camera.fx;
  if (lens == Lens::pinhole || angle < 1e-9)
    return {u, v};
  return Eigen::Vector2d(camera.cx, camera.cy) + std::tan(angle) / angle * offset;
}

} // namespace pcl_semantic::synthetic
