// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/rectifier.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A stereo or RGB-D camera or another live source. Frames arrive at their own
 * times, without a known end. */
class LiveCamera {
public:
  virtual ~LiveCamera() = default;

  /** \brief Waits for the next pairs, without decoding them: for a folder or a video at
   * most 1/20 s, for a camera or a stream until they deliver.
   * \return number of new pairs; 0 = none
   * \throws BadInputException with the reason, if no more can arrive */
  virtual int grab() = 0;

  /** \brief Whether no more pairs will arrive. */
  virtual bool hasEnded() const = 0;

  /** \brief Returns the newest frame, rectified or undistorted. Its time is relative to
   * the opening of the camera [s].
   * \throws BadInputException if it is damaged or has another size */
  virtual SensorFrame retrieve() = 0;

  /** \brief Whether frames are RgbdFrame instead of StereoFrame. */
  virtual bool
  hasDepth() const
  {
    return false;
  }

  /** \brief The rectified pair, with the size of the images. The baseline of an RGB-D
   * camera is to be ignored. */
  const StereoCamera&
  camera() const
  {
    return pair_.camera;
  }

  /** \brief As FrameSequence::T_camera0_camera(). */
  const Eigen::Isometry3d&
  T_camera0_camera() const
  {
    return pair_.T_camera0_camera;
  }

  /** \brief Doubts about the calibration, one per line. */
  const std::vector<std::string>&
  doubts() const
  {
    return pair_.doubts;
  }

protected:
  RectifiedPair pair_; ///< set by the constructors
};

} // namespace pcl_semantic
