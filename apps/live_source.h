// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/dataset/frame_grabber.h>
#include <pcl_semantic/dataset/frame_source.h>
#include <pcl_semantic/pipeline/map_inputs.h>

#include <memory>
#include <optional>
#include <string>

namespace pcl_semantic::tool {

/** \brief Live frames of a camera, a video or a folder. Each call returns the newest
 * one, until the source ends or an interrupt arrives. */
class LiveSource : public FrameSource {
public:
  /** \brief Waits for the first frame.
   * \throws Exit if it is interrupted, BadInputException */
  explicit LiveSource(const MapInputs& inputs);

  std::optional<SensorFrame> next() override;

  /** \brief Time since the arrival of the last pair [s]. */
  double secondsSinceGrabbed() const;

  /** \brief Number of pairs skipped during mapping. */
  int
  dropped() const
  {
    return grabber_->dropped();
  }

  /** \brief Number of pairs that could not be decoded. */
  int
  damaged() const
  {
    return damaged_;
  }

private:
  SequenceFiles files_;
  std::string name_; ///< for messages
  std::unique_ptr<FrameGrabber> grabber_;
  FrameGrabber::Clock::time_point grabbed_;
  int damaged_ = 0;
};

} // namespace pcl_semantic::tool
