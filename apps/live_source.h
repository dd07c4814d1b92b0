// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/dataset/frame_source.h>
#include <pcl_semantic/dataset/sequence_files.h>
#include <pcl_semantic/dataset/stereo_grabber.h>

#include <memory>
#include <optional>

namespace pcl_semantic::tool {

/** \brief Pairs of a camera, a video or a folder that fills, as they come: the newest
 * pair whenever the mapper asks, until there are no more or an interrupt comes. */
class LiveSource : public FrameSource {
public:
  /** \brief Waits for the first pair.
   * \throws Exit if it is interrupted meanwhile, BadInputException */
  explicit LiveSource(const SequenceFiles& files);

  std::optional<SensorFrame> next() override;

  /** \brief Since the last pair came [s]. */
  double secondsSinceGrabbed() const;

  /** \brief Pairs that came while an earlier one was mapped. */
  int
  dropped() const
  {
    return grabber_->dropped();
  }

  /** \brief Pairs that could not be decoded. */
  int
  damaged() const
  {
    return damaged_;
  }

private:
  SequenceFiles files_;
  std::unique_ptr<StereoGrabber> grabber_;
  StereoGrabber::Clock::time_point grabbed_;
  int damaged_ = 0;
};

} // namespace pcl_semantic::tool
