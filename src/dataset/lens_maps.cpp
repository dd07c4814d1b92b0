// SPDX-License-Identifier: BSD-3-Clause
#include "lens_maps.h"

#include "core/fail.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pcl_semantic {

namespace {

constexpr double kScale = 8.0; // maximum change of the focal length

constexpr int kStep = 8;         // [px] between checked pixels
constexpr double kUsable = 0.95; // required fraction of valid ones
constexpr double kFolded = 0.01; // maximum fraction beyond a fold

} // namespace

LensMaps
lensMapsOf(const LensModel& lens, const cv::Mat& R, const cv::Mat& P,
           const cv::Size& size)
{
  LensMaps maps;
  if (lens.is_fisheye)
    cv::fisheye::initUndistortRectifyMap(lens.K, lens.D, R, P, size, CV_16SC2,
                                         maps.whole, maps.fraction);
  else
    cv::initUndistortRectifyMap(lens.K, lens.D, R, P, size, CV_16SC2, maps.whole,
                                maps.fraction);
  return maps;
}

void
requireUsable(const LensMaps& maps, const std::string& says)
{
  const cv::Mat2s& whole = maps.whole;
  const cv::Rect image({}, whole.size());
  int usable = 0, folded = 0, all = 0;
  for (int y = 0; y + kStep < whole.rows; y += kStep)
    for (int x = 0; x + kStep < whole.cols; x += kStep) {
      const cv::Vec2s& here = whole(y, x);
      const cv::Vec2i right = cv::Vec2i(whole(y, x + kStep)) - cv::Vec2i(here);
      const cv::Vec2i below = cv::Vec2i(whole(y + kStep, x)) - cv::Vec2i(here);
      const bool keeps_sides =
          std::int64_t(right[0]) * below[1] > std::int64_t(right[1]) * below[0];
      folded += !keeps_sides;
      usable += keeps_sides && image.contains(cv::Point(here));
      ++all;
    }
  if (usable < kUsable * all || folded > kFolded * all)
    fail<InvalidParameterException>("only ", 100 * usable / std::max(all, 1), " % of ",
                                    says);
}

void
requireFocalLength(double undistorted, double original, const std::string& advice)
{
  if (!std::isfinite(undistorted))
    badParameter("the angle of view is more than a pinhole image shows; ", advice);
  const double scale = undistorted / original;
  if (!(scale < kScale && scale > 1.0 / kScale))
    fail<InvalidParameterException>("the images would have a focal length of ",
                                    undistorted, " px instead of ", original, " px; ",
                                    advice);
}

} // namespace pcl_semantic
