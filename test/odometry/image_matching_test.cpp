// SPDX-License-Identifier: BSD-3-Clause
#include <odometry/circle_tracker.h>
#include <odometry/corners.h>

#include <opencv2/imgproc.hpp>

#include <gtest/gtest.h>

namespace {

using namespace pcl_semantic::odometry;

// Smooth random grey levels, moved by (dx, dy) pixels.
cv::Mat
texture(double dx, double dy)
{
  cv::Mat noise(220, 420, CV_32FC1);
  cv::theRNG().state = 7;
  cv::randu(noise, 0.0, 255.0);
  cv::GaussianBlur(noise, noise, {}, 2.0);
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 10 + dx, 0, 1, 10 + dy);
  cv::Mat moved, image;
  cv::warpAffine(noise, moved, shift, noise.size(), cv::INTER_CUBIC,
                 cv::BORDER_REFLECT);
  moved(cv::Rect(20, 20, 380, 180)).convertTo(image, CV_8UC1, 6.0, -640.0);
  return image;
}

} // namespace

TEST(CornerDetector, OneACellAndNoneWhereThereAreOldOnes)
{
  const cv::Mat image = texture(0, 0);
  const std::vector<cv::Point2f> corners = detectCorners(image, {}, 100);
  EXPECT_GT(corners.size(), 30u);
  EXPECT_LE(corners.size(), 130u);
  EXPECT_TRUE(detectCorners(image, corners, 100).size() < corners.size() / 2);
  EXPECT_TRUE(
      detectCorners(cv::Mat(180, 380, CV_8UC1, cv::Scalar(90)), {}, 100).empty());
}

TEST(EpipolarSearch, FindsWholePixels)
{
  const cv::Mat left = texture(0, 0), right = texture(-23, 0);
  int found = 0;
  for (const cv::Point2f& corner : detectCorners(left, {}, 100)) {
    const int disparity = searchDisparity(left, right, corner, 60);
    if (corner.x > 40) {
      EXPECT_EQ(disparity, 23);
      ++found;
    }
  }
  EXPECT_GT(found, 20);
}

TEST(EpipolarSearch, SaysNothingWhereNothingIsClear)
{
  const cv::Mat flat(180, 380, CV_8UC1, cv::Scalar(90));
  EXPECT_EQ(searchDisparity(flat, flat, {200, 90}, 60), -1);
  EXPECT_EQ(searchDisparity(flat, flat, {2, 90}, 60), -1); // too near the border
  cv::Mat stripes(180, 380, CV_8UC1);
  for (int x = 0; x < stripes.cols; ++x)
    stripes.col(x).setTo(x % 12 < 6 ? 60 : 180);
  EXPECT_EQ(searchDisparity(stripes, stripes, {200, 90}, 60), -1);
}

TEST(CircleTracker, FollowsToAFractionOfAPixel)
{
  CircleTracker tracker;
  tracker.push(texture(0, 0), texture(-9.6, 0));
  tracker.push(texture(3.3, -1.8), texture(-7.1, -1.8));
  std::vector<StereoFeature> before, now;
  for (const cv::Point2f& corner : detectCorners(texture(0, 0), {}, 100))
    if (corner.x > 40 && corner.x < 340 && corner.y > 30 && corner.y < 150)
      before.push_back({corner, corner - cv::Point2f(9.6f, 0.0f), true});
  now = before;
  tracker.track(before, now);
  ASSERT_GT(now.size(), 20u);
  std::size_t found = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (!now[i].is_found)
      continue;
    ++found;
    EXPECT_LT(cv::norm(now[i].left - before[i].left - cv::Point2f(3.3f, -1.8f)), 0.1);
    EXPECT_NEAR(now[i].left.x - now[i].right.x, 10.4, 0.1);
  }
  EXPECT_GT(found, now.size() * 9 / 10);
}

TEST(CircleTracker, WhatDoesNotComeBackIsNotFound)
{
  CircleTracker tracker;
  tracker.push(texture(0, 0), texture(-9, 0));
  tracker.push(texture(70, 50), texture(-9, 90)); // nothing to do with one another
  std::vector<StereoFeature> before, now;
  for (const cv::Point2f& corner : detectCorners(texture(0, 0), {}, 100))
    before.push_back({corner, corner - cv::Point2f(9, 0), true});
  now = before;
  tracker.track(before, now);
  std::size_t found = 0;
  for (const StereoFeature& feature : now)
    found += feature.is_found;
  EXPECT_LT(found, now.size() / 10);
}
