// SPDX-License-Identifier: BSD-3-Clause
#include "sgbm.h"
#include "core/grey_image.h"
#include "image_pair.h"

#include <pcl_semantic/core/exceptions.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace pcl_semantic {

namespace {

// Of its matches in KITTI's streets, gross errors aside (doc/stereo.md). [px]
constexpr double deviation = 0.5;

constexpr float disparity_scale = 1.0f / cv::StereoMatcher::DISP_SCALE;

void
require(bool valid, const char* name, int value, const char* expected)
{
  if (!valid)
    PCL_THROW_EXCEPTION(InvalidParameterException, "SGBM: " << name << " is " << value
                                                            << ", expected "
                                                            << expected);
}

int
openCvMode(Sgbm::Mode mode)
{
  switch (mode) {
  case Sgbm::Mode::three_way:
    return cv::StereoSGBM::MODE_SGBM_3WAY;
  case Sgbm::Mode::five_way:
    return cv::StereoSGBM::MODE_SGBM;
  case Sgbm::Mode::eight_way:
    return cv::StereoSGBM::MODE_HH;
  }
  return cv::StereoSGBM::MODE_SGBM_3WAY;
}

cv::Mat
paddedGrey(const cv::Mat& image, int padding)
{
  cv::Mat padded;
  cv::copyMakeBorder(greyImage(image), padded, 0, 0, padding, 0, cv::BORDER_REPLICATE);
  return padded;
}

// Fixed point with padding to pixels without; matches left of the right image are none.
cv::Mat
cropDisparity(const cv::Mat& fixed, int padding)
{
  cv::Mat disparity(fixed.rows, fixed.cols - padding, CV_32FC1);
  for (int v = 0; v < disparity.rows; ++v) {
    const std::int16_t* const from = fixed.ptr<std::int16_t>(v) + padding;
    float* const to = disparity.ptr<float>(v);
    for (int u = 0; u < disparity.cols; ++u) {
      const float d = static_cast<float>(from[u]) * disparity_scale;
      to[u] = d > 0.0f && d <= static_cast<float>(u) ? d : 0.0f;
    }
  }
  return disparity;
}

} // namespace

void
Sgbm::Parameters::validate() const
{
  require(disparities > 0 && disparities <= 1024 && disparities % 16 == 0,
          "disparities", disparities, "a multiple of 16 up to 1024");
  // OpenCV adds costs and penalties in 16 bits: these bounds keep a path's sum below.
  require(block_size >= 1 && block_size <= 11 && block_size % 2 == 1, "block_size",
          block_size, "an odd number from 1 to 11");
  require(small_step_penalty >= 1 && small_step_penalty < 100, "small_step_penalty",
          small_step_penalty, "1 to 99");
  require(large_step_penalty > small_step_penalty && large_step_penalty <= 100,
          "large_step_penalty", large_step_penalty,
          "more than small_step_penalty, up to 100");
  require(left_right_tolerance <= 1024, "left_right_tolerance", left_right_tolerance,
          "1024 at most");
  require(uniqueness >= 0 && uniqueness <= 100, "uniqueness", uniqueness, "0 to 100");
  require(gradient_cap >= 15 && gradient_cap <= 63, "gradient_cap", gradient_cap,
          "15 to 63");
  require(speckle_size >= 0, "speckle_size", speckle_size, "0 or more");
  require(speckle_range >= 0 && speckle_range <= 1024, "speckle_range", speckle_range,
          "0 to 1024");
}

Sgbm::Sgbm(const Parameters& parameters) : parameters_(parameters)
{
  parameters_.validate();
  const int window = parameters_.block_size * parameters_.block_size;
  matcher_ = cv::StereoSGBM::create(
      0, parameters_.disparities, parameters_.block_size,
      parameters_.small_step_penalty * window, parameters_.large_step_penalty * window,
      parameters_.left_right_tolerance, parameters_.gradient_cap,
      parameters_.uniqueness, parameters_.speckle_size, parameters_.speckle_range,
      openCvMode(parameters_.mode));
}

DisparityImage
Sgbm::estimate(const cv::Mat& left, const cv::Mat& right)
{
  requireImagePair(left, right);
  const int padding = parameters_.disparities;
  cv::Mat fixed;
  matcher_->compute(paddedGrey(left, padding), paddedGrey(right, padding), fixed);
  const cv::Mat disparity = cropDisparity(fixed, padding);
  return {disparity, cv::Mat(disparity.size(), CV_32FC1, cv::Scalar(deviation))};
}

} // namespace pcl_semantic
