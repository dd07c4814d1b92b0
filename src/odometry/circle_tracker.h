// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <vector>

namespace pcl_semantic::odometry {

/** \brief New corners, at most one in each cell of a grid that holds no old one.
 *
 * Candidates come from FAST; of a cell's candidates the one is taken whose window
 * localises best (largest smaller eigenvalue of the gradients, Shi and Tomasi 1994).
 * \param[in] image CV_8UC1 \param[in] old points that are followed already
 * \param[in] wanted about how many cells the grid has */
std::vector<cv::Point2f> detectCorners(const cv::Mat& image,
                                       const std::vector<cv::Point2f>& old, int wanted);

/** \brief Whole-pixel disparity of a corner of the left image: the smallest sum of
 * absolute differences of 11 x 11 pixels along the row of the right image.
 * \return -1 if there is no clear one */
int searchDisparity(const cv::Mat& left, const cv::Mat& right,
                    const cv::Point2f& corner, int max_disparity);

/** \brief A feature in both images of a pair [px]. */
struct StereoFeature {
  cv::Point2f left, right;
  bool is_found = false;
};

/** \brief Follows features around the circle left before, left now, right now, right
 * before by pyramidal Lucas-Kanade; one that does not come back to where it started is
 * not found (Geiger et al., StereoScan, 2011). */
class CircleTracker {
public:
  /** \brief Takes the next pair, CV_8UC1; the one that was there becomes "before". */
  void push(const cv::Mat& left, const cv::Mat& right);

  /** \brief \param[in] before where features were \param[in,out] now where they are
   * expected, then where they are */
  void track(const std::vector<StereoFeature>& before,
             std::vector<StereoFeature>& now) const;

  /** \brief Finds features of the left image now in the right one.
   * \param[in,out] features left, and the expected right; is_found is set */
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
