// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_source.h"

#include <pcl_semantic/dataset/stereo_grabber.h>
#include <pcl_semantic/files/pose_doubts.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Pairs of a camera, a video or a folder that fills, as they come: the
 * newest whenever the mapper asks, until there are no more or an interrupt comes.
 *
 * Its mapper has no labels of its own: takePredictor() is for LateLabels. */
class LiveSource : public MapSource {
public:
  /** \brief Waits for the first pair.
   * \throws Exit if it is interrupted meanwhile, BadInputException, BadModelException,
   * InvalidParameterException */
  explicit LiveSource(const MapArguments& arguments);

  std::unique_ptr<PoseSource>
  openPoses(std::vector<std::string>& doubts) const override;

  std::vector<FrameTime>
  times() const override
  {
    return {};
  }

  std::optional<SensorFrame> next() override;

  void
  skip(const std::vector<FrameRecord>&) override
  {}

  std::unique_ptr<LabelPredictor>
  takePredictor()
  {
    return std::move(labels_);
  }

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
  std::optional<StoredTrajectory> trajectory_; // none: odometry
  std::unique_ptr<LabelPredictor> labels_;
  std::unique_ptr<StereoGrabber> grabber_;
  std::optional<PairWatch> watch_;
  StereoGrabber::Clock::time_point grabbed_;
  int damaged_ = 0;
};

} // namespace pcl_semantic::tool
