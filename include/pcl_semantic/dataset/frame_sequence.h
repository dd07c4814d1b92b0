// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/sensor_frame.h>
#include <pcl_semantic/core/stereo_camera.h>

#include <Eigen/Geometry>

#include <cstddef>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A recorded sequence of stereo frames. */
class FrameSequence {
public:
  virtual ~FrameSequence() = default;

  /** \brief Number of frames that are present. */
  virtual std::size_t size() const = 0;

  /** \brief Number of the i-th frame in the whole sequence; may have gaps. */
  virtual int frameNumber(std::size_t i) const = 0;

  /** \brief Time of the i-th frame [s], without reading its images. */
  virtual double timestamp(std::size_t i) const = 0;

  /** \brief Reads the images of the i-th frame.
   * \throws BadInputException if an image is missing, damaged or of another size */
  virtual StereoFrame frame(std::size_t i) const = 0;

  /** \brief The stereo pair that took the images, their size filled in. */
  virtual const StereoCamera& camera() const = 0;

  /** \brief Pose of that pair's left camera in camera 0, the one whose poses are in
   * trajectory files [m]. */
  virtual const Eigen::Isometry3d&
  T_camera0_camera() const
  {
    static const Eigen::Isometry3d identity = Eigen::Isometry3d::Identity();
    return identity;
  }

  /** \brief Path of the trajectory that comes with the sequence; empty if none does. */
  virtual std::string
  posesPath() const
  {
    return {};
  }
};

} // namespace pcl_semantic
