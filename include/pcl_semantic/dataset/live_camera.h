// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/dataset/rectifier.h>
#include <pcl_semantic/images/sensor_frame.h>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A stereo camera, or what plays its part, whose pairs come by themselves: at
 * their own time, without a known end. */
class LiveCamera {
public:
  virtual ~LiveCamera() = default;

  /** \brief Waits for the next pairs, without decoding them: of a folder or a video not
   * longer than a twentieth of a second, of a camera or a stream as long as these do.
   * \return how many came; 0 = none
   * \throws BadInputException if no more can come, and why */
  virtual int grab() = 0;

  /** \brief Whether no more will come. */
  virtual bool hasEnded() const = 0;

  /** \brief The newest of the pairs that came last, rectified; its time is that since
   * the camera was opened [s]. \throws BadInputException if it is damaged, or of
   * another size */
  virtual StereoFrame retrieve() = 0;

  /** \brief The rectified pair, its size filled in. */
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

  /** \brief Doubts about the calibration, a line each. */
  const std::vector<std::string>&
  doubts() const
  {
    return pair_.doubts;
  }

protected:
  RectifiedPair pair_; ///< set by the constructors
};

} // namespace pcl_semantic
