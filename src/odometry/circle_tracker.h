// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "feature_tracker.h"
#include "image_flow.h"

#include <opencv2/core.hpp>

#include <vector>

namespace pcl_semantic::odometry {

/** \brief Integer disparity of a corner of the left image: the smallest sum of absolute
 * differences of 11 x 11 pixels along the row of the right image.
 * \return -1 if there is no unique minimum */
int searchDisparity(const cv::Mat& left, const cv::Mat& right,
                    const cv::Point2f& corner, int max_disparity);

/** \brief Tracks features around the circle left before, left now, right now, right
 * before by pyramidal Lucas-Kanade. A feature that does not return to its start is
 * rejected (Geiger et al., StereoScan, 2011). */
class CircleTracker : public FeatureTracker {
public:
  /** \brief Adds the next pair, CV_8UC1; the current pair becomes "before". */
  void push(const cv::Mat& left, const cv::Mat& right);

  void track(const std::vector<StereoFeature>& before,
             std::vector<StereoFeature>& now) const override;

  std::vector<StereoFeature> featuresAt(const std::vector<cv::Point2f>& corners,
                                        int max_disparity) const override;

  /** \brief Matches features of the current left image in the right one.
   * \param[in,out] features left, and predicted right position; sets is_found */
  void matchStereo(std::vector<StereoFeature>& features) const;

  const cv::Mat&
  image() const override
  {
    return now_.left[0];
  }

  const cv::Mat&
  right() const
  {
    return now_.right[0];
  }

private:
  struct Pair {
    ImagePyramid left, right;
  };

  Pair before_, now_;
};

} // namespace pcl_semantic::odometry
