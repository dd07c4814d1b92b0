// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/stereo/disparity_engines.h>
#include <pcl_semantic/stereo/disparity_image.h>

#include <opencv2/imgproc.hpp>

#include <gtest/gtest.h>

namespace pcl_semantic {

TEST(DisparityEngines, EachFindsAShift)
{
  cv::Mat texture(120, 400, CV_8UC1);
  cv::RNG(3).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {5, 5}, 1.0);
  const int shift = 21;
  const cv::Mat left = texture.colRange(0, 360).clone();
  const cv::Mat right = texture.colRange(shift, 360 + shift).clone();
  ASSERT_EQ(disparityEngines().size(), 3u);
  for (const std::string& name : disparityEngines()) {
    const DisparityImage image =
        makeDisparityEstimator(name, 64)->estimate(left, right);
    ASSERT_EQ(image.deviation.size(), image.disparity.size()) << name;
    int right_ones = 0, pixels = 0;
    for (int v = 5; v < 115; ++v)
      for (int u = 64; u < 350; ++u, ++pixels)
        right_ones += std::abs(image.disparity.at<float>(v, u) - float(shift)) < 0.5f &&
                      image.deviation.at<float>(v, u) > 0.0f;
    EXPECT_GT(right_ones, 0.99 * pixels) << name;
  }
}

TEST(DisparityEngines, OthersAreRefused)
{
  EXPECT_EQ(thrownMessage<InvalidParameterException>(
                [] { makeDisparityEstimator("orb", 128); }),
            "the stereo engine is 'orb', expected sgm, elas or sgbm");
  for (const std::string& name : disparityEngines())
    for (const int disparities : {0, -64, 100})
      EXPECT_TRUE(holds(thrownMessage<InvalidParameterException>(
                            [&] { makeDisparityEstimator(name, disparities); }),
                        "disparities is " + std::to_string(disparities)));
}

TEST(DisparityImage, FarIsBlueNearIsRedNoneIsBlack)
{
  const cv::Mat disparity = (cv::Mat_<float>(1, 4) << 0.0f, 4.0f, 60.0f, 500.0f);
  const cv::Mat picture = drawDisparity(disparity, 64.0);
  ASSERT_EQ(picture.type(), CV_8UC3);
  const auto bgr = [&](int u) { return picture.at<cv::Vec3b>(0, u); };
  EXPECT_EQ(bgr(0), cv::Vec3b(0, 0, 0));
  EXPECT_GT(bgr(1)[0], bgr(1)[2]);
  EXPECT_GT(bgr(2)[2], bgr(2)[0]);
  EXPECT_GT(bgr(3)[2], bgr(3)[0]); // nearer than the scale: as its end
}

TEST(DisparityImage, OtherImagesAreRefused)
{
  EXPECT_THROW(drawDisparity(cv::Mat(2, 2, CV_16UC1)), InvalidParameterException);
  EXPECT_THROW(drawDisparity(cv::Mat(2, 2, CV_32FC1), 0.0), InvalidParameterException);
}

} // namespace pcl_semantic
