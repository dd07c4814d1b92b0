// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <vector>

namespace pcl_semantic::odometry {

/** \brief A feature in both images of a pair [px]. */
struct StereoFeature {
  cv::Point2f left, right;
  bool is_found = false;
};

/** \brief Tracks features with disparities from frame to frame. */
class FeatureTracker {
public:
  virtual ~FeatureTracker() = default;

  /** \brief Tracks features into the current frame.
   * \param[in] before positions in the previous frame
   * \param[in,out] now predicted, then tracked positions */
  virtual void track(const std::vector<StereoFeature>& before,
                     std::vector<StereoFeature>& now) const = 0;

  /** \brief The features at corners of the current image that have a disparity.
   * \param[in] max_disparity [px] */
  virtual std::vector<StereoFeature> featuresAt(const std::vector<cv::Point2f>& corners,
                                                int max_disparity) const = 0;

  /** \brief The current image, CV_8UC1: the left one of a pair. */
  virtual const cv::Mat& image() const = 0;
};

} // namespace pcl_semantic::odometry
