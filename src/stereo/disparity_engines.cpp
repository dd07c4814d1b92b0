// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/stereo/disparity_engines.h>

#include "core/fail.h"
#include "elas.h"
#include "image_pair.h"
#include "images/grey_image.h"
#include "semi_global_matcher.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <iterator>

namespace pcl_semantic {

namespace {

/** \brief OpenCV's semi-global matching (H. Hirschmueller, PAMI 2008) along three
 * directions. */
class Sgbm : public DisparityEstimator {
public:
  explicit Sgbm(int disparities)
      : disparities_(disparities),
        matcher_(cv::StereoSGBM::create(0, disparities, block_size, small_step_penalty,
                                        large_step_penalty, left_right_tolerance,
                                        gradient_cap, uniqueness, speckle_size,
                                        speckle_range, cv::StereoSGBM::MODE_SGBM_3WAY))
  {}

  DisparityImage
  estimate(const cv::Mat& left, const cv::Mat& right) override
  {
    requireImagePair(left, right);
    cv::Mat fixed;
    matcher_->compute(padded(left), padded(right), fixed);
    cv::Mat1f disparity;
    fixed.colRange(disparities_, fixed.cols)
        .convertTo(disparity, CV_32F, 1.0 / cv::StereoMatcher::DISP_SCALE);
    for (int v = 0; v < disparity.rows; ++v)
      for (int u = 0; u < disparity.cols; ++u)
        if (float& d = disparity(v, u); !(d > 0.0f && d <= float(u)))
          d = 0.0f; // none, or beyond the left border of the right image
    return {disparity, cv::Mat1f(disparity.size(), deviation)};
  }

private:
  static constexpr int block_size = 5;                                    // [px]
  static constexpr int small_step_penalty = 16 * block_size * block_size; // P1
  static constexpr int large_step_penalty = 64 * block_size * block_size; // P2
  static constexpr int left_right_tolerance = 1;                          // [px]
  static constexpr int gradient_cap = 63;  // gradients are clamped to this
  static constexpr int uniqueness = 10;    // margin of the best cost over others [%]
  static constexpr int speckle_size = 200; // smaller regions are removed [px]
  static constexpr int speckle_range = 2;  // disparity step within a region [px]
  // On KITTI, gross errors excluded (doc/stereo.md). [px]
  static constexpr float deviation = 0.5f;

  // Padding allows matching the first columns. Isolated: without pixels around a view.
  cv::Mat
  padded(const cv::Mat& image) const
  {
    cv::Mat result;
    cv::copyMakeBorder(greyImage(image), result, 0, 0, disparities_, 0,
                       cv::BORDER_REPLICATE | cv::BORDER_ISOLATED);
    return result;
  }

  int disparities_;
  cv::Ptr<cv::StereoSGBM> matcher_;
};

template <typename Estimator>
std::unique_ptr<DisparityEstimator>
make(int disparities)
{
  return std::make_unique<Estimator>(disparities);
}

struct Engine {
  const char *name, *title;
  int step, largest; // step and maximum of the disparities
  const char* expected;
  std::unique_ptr<DisparityEstimator> (*make)(int disparities);
};

const Engine engines[] = {
    {"sgm", "semi-global matching", 64, 256, "64, 128, 192 or 256",
     make<SemiGlobalMatcher>},
    {"elas", "ELAS", 16, 1024, "a multiple of 16 up to 1024", make<Elas>},
    {"sgbm", "SGBM", 16, 1024, "a multiple of 16 up to 1024", make<Sgbm>}};

} // namespace

cv::Mat
drawDisparity(const cv::Mat& disparity, double nearest)
{
  if (disparity.type() != CV_32FC1 || !(nearest > 0.0))
    badParameter("drawDisparity: expected an image of floats and a disparity "
                 "of more than 0");
  // The square root spreads the colours of far points.
  cv::Mat fraction, levels, image;
  cv::sqrt(cv::max(disparity, 0.0) / nearest, fraction);
  fraction.convertTo(levels, CV_8UC1, 255.0);
  cv::applyColorMap(levels, image, cv::COLORMAP_TURBO);
  image.setTo(cv::Scalar::all(0), ~(disparity > 0.0));
  return image;
}

const std::vector<std::string>&
disparityEngines()
{
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const Engine& engine : engines)
      result.push_back(engine.name);
    return result;
  }();
  return names;
}

std::unique_ptr<DisparityEstimator>
makeDisparityEstimator(const std::string& name, int disparities)
{
  const auto* const engine =
      std::find_if(std::begin(engines), std::end(engines),
                   [&](const Engine& each) { return each.name == name; });
  if (engine == std::end(engines))
    badParameter("the stereo engine is '", name, "', expected sgm, elas or sgbm");
  if (disparities <= 0 || disparities > engine->largest ||
      disparities % engine->step != 0)
    badParameter(engine->title, ": disparities is ", disparities, ", expected ",
                 engine->expected);
  return engine->make(disparities);
}

} // namespace pcl_semantic
