// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lens.h"
#include "room.h"

#include <pcl_semantic/core/stereo_camera.h>

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

/** \brief Image of an RGB-D camera in the room, and its ground truth. */
struct RoomView {
  int frame = 0;
  cv::Mat colour;      ///< CV_8UC3 (BGR)
  cv::Mat depth;       ///< CV_32FC1, exact, along the optical axis [m]
  cv::Mat labels;      ///< CV_8UC1, RoomClass
  StereoCamera camera; ///< its baseline is to be ignored
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/** \brief Renders the synthetic room by casting rays, with the same bytes for any
 * number of threads. */
class RoomRenderer {
public:
  /** \throws InvalidParameterException unless \a width x \a height lies within
   * 64 x 32 and 4096 x 4096 */
  RoomRenderer(const SyntheticRoom& room, int width, int height,
               synthetic::Lens lens = synthetic::Lens::pinhole);

  /** \brief The camera of a Kinect, scaled to the width. With another lens, its focal
   * length. */
  const StereoCamera&
  camera() const
  {
    return camera_;
  }

  /** \throws InvalidParameterException if the frame does not exist */
  RoomView render(int frame) const;

private:
  SyntheticRoom room_;
  StereoCamera camera_;
  synthetic::Lens lens_;
};

/** \brief Measures the depths of a view as a Kinect does: normal noise with a deviation
 * of 0.0012 + 0.0019 (z - 0.4)^2 [m] (Nguyen, Izadi and Lovell 2012, axial noise).
 * \param[in] seed of the noise
 * \param[in] scale of the deviation; 0 = exact
 * \return CV_16UC1 [mm] */
cv::Mat measuredDepth(const RoomView& view, std::uint32_t seed, double scale = 1.0);

} // namespace pcl_semantic
