// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <vector>

namespace pcl_semantic::odometry {

/** \brief Detects new corners, at most one in each grid cell without an old one.
 *
 * Candidates come from FAST. In each cell, the candidate that localises best wins
 * (largest smaller eigenvalue of the gradients, Shi and Tomasi 1994).
 * \param[in] image CV_8UC1
 * \param[in] old points that are already tracked
 * \param[in] wanted approximate number of grid cells */
std::vector<cv::Point2f> detectCorners(const cv::Mat& image,
                                       const std::vector<cv::Point2f>& old, int wanted);

/** \brief Integer disparity of a corner of the left image: the smallest sum of absolute
 * differences of 11 x 11 pixels along the row of the right image.
 * \return -1 if there is no unique minimum */
int searchDisparity(const cv::Mat& left, const cv::Mat& right,
                    const cv::Point2f& corner, int max_disparity);

/** \brief A feature in both images of a pair [px]. */
struct StereoFeature {
  cv::Point2f left, right;
  bool is_found = false;
};

/** \brief Tracks features around the circle left before, left now, right now, right
 * before by pyramidal Lucas-Kanade. A feature that does not return to its start is
 * rejected (Geiger et al., StereoScan, 2011). */
class CircleTracker {
public:
  /** \brief Adds the next pair, CV_8UC1; the current pair becomes "before". */
  void push(const cv::Mat& left, const cv::Mat& right);

  /** \brief Tracks features into the current pair.
   * \param[in] before positions in the previous pair
   * \param[in,out] now predicted, then tracked positions */
  void track(const std::vector<StereoFeature>& before,
             std::vector<StereoFeature>& now) const;

  /** \brief Matches features of the current left image in the right one.
   * \param[in,out] features left, and predicted right position; sets is_found */
  void matchStereo(std::vector<StereoFeature>& features) const;

  const cv::Mat&
  left() const
  {
    return now_.left[0];
  }

  const cv::Mat&
  right() const
  {
    return now_.right[0];
  }

private:
  using Pyramid = std::vector<cv::Mat>;

  struct Pair {
    Pyramid left, right;
  };

  Pair before_, now_;
};

} // namespace pcl_semantic::odometry
