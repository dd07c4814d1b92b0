// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "feature_tracker.h"
#include "image_flow.h"

#include <vector>

namespace pcl_semantic::odometry {

/** \brief Tracks features of RGB-D frames by pyramidal Lucas-Kanade, and rejects those
 * that do not return to their start. The right image of a feature is where the depth
 * image puts it; a feature at an edge of the depths, or without depth, is rejected. */
class DepthTracker : public FeatureTracker {
public:
  /** \brief Adds the next frame.
   * \param[in] image CV_8UC1
   * \param[in] disparities CV_32FC1 of the same size, f b / depth [px]; 0 = no depth */
  void push(const cv::Mat& image, const cv::Mat1f& disparities);

  void track(const std::vector<StereoFeature>& before,
             std::vector<StereoFeature>& now) const override;

  std::vector<StereoFeature> featuresAt(const std::vector<cv::Point2f>& corners,
                                        int max_disparity) const override;

  const cv::Mat&
  image() const override
  {
    return now_[0];
  }

private:
  float disparityAt(const cv::Point2f& point) const;

  ImagePyramid before_, now_;
  cv::Mat1f disparities_;
};

} // namespace pcl_semantic::odometry
