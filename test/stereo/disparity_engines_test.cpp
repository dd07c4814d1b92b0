// SPDX-License-Identifier: BSD-3-Clause
#include "support/same_image.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/threads.h>
#include <pcl_semantic/images/image_file.h>
#include <pcl_semantic/stereo/disparity_engines.h>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdlib>

namespace pcl_semantic {
namespace {

constexpr int width = 320, height = 120;
constexpr float far_disparity = 9.0f, near_disparity = 34.0f;
constexpr float matched_deviation = 0.6f; // filled pixels are less certain

cv::Mat
makeTexture(unsigned seed)
{
  cv::Mat texture(height, width + 64, CV_8UC1);
  cv::RNG(seed).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, cv::Size(5, 5), 0.0);
  return texture;
}

struct Pair {
  cv::Mat1b left = cv::Mat1b(height, width), right = left.clone();
  cv::Mat1f disparity =
      cv::Mat1f(height, width); // also where the match is outside the right image
};

// A square in front of a background.
Pair
makeSquare()
{
  const cv::Mat1b back = makeTexture(7), front = makeTexture(8);
  const auto near = [](int u, int v) {
    return u >= 140 && u < 240 && v >= 30 && v < 90;
  };
  Pair pair;
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      pair.left(v, u) = (near(u, v) ? front : back)(v, u);
      pair.disparity(v, u) = near(u, v) ? near_disparity : far_disparity;
      pair.right(v, u) = near(u + 34, v) ? front(v, u + 34) : back(v, u + 9);
    }
  return pair;
}

// Left of the square the right camera sees the square.
const cv::Rect hidden(118, 36, 18, 48);

DisparityImage
estimate(const std::string& engine, const cv::Mat& left, const cv::Mat& right,
         int disparities = 64)
{
  return makeDisparityEstimator(engine, disparities)->estimate(left, right);
}

int
countRight(const cv::Mat1f& found, const cv::Mat1f& expected, double tolerance = 0.5)
{
  return cv::countNonZero((found > 0.0f) & (cv::abs(found - expected) <= tolerance));
}

TEST(DisparityEngines, FindASquareAndItsBackground)
{
  const Pair pair = makeSquare();
  const cv::Mat1b is_near = pair.disparity == near_disparity;
  for (const auto& [engine, min_right] :
       {std::pair("sgm", 0.80), {"elas", 0.95}, {"sgbm", 0.85}}) {
    SCOPED_TRACE(engine);
    const DisparityImage image = estimate(engine, pair.left, pair.right);
    ASSERT_EQ(image.disparity.type(), CV_32FC1);
    ASSERT_EQ(image.disparity.size(), pair.left.size());
    ASSERT_EQ(image.deviation.size(), pair.left.size());
    const cv::Mat1f found = image.disparity;
    EXPECT_GT(countRight(found, pair.disparity), min_right * width * height);
    EXPECT_GT(cv::countNonZero(is_near & (cv::abs(found - pair.disparity) <= 0.5)),
              0.75 * 100 * 60);
    // The first columns, too.
    const cv::Range columns(12, 60);
    EXPECT_GT(countRight(found.colRange(columns), pair.disparity.colRange(columns)),
              0.95 * height * columns.size());
  }
}

TEST(DisparityEngines, FillWhatIsHiddenExceptSgbm)
{
  const Pair pair = makeSquare();
  for (const std::string engine : {"sgm", "elas"}) {
    SCOPED_TRACE(engine);
    const DisparityImage image = estimate(engine, pair.left, pair.right);
    EXPECT_EQ(cv::countNonZero(image.disparity), width * height);
    EXPECT_TRUE(isSameImage(image.disparity > 0.0f, image.deviation > 0.0f));
    const cv::Mat matched = image.deviation < matched_deviation;
    EXPECT_LT(cv::countNonZero(matched(hidden)), 0.1 * hidden.area());
    EXPECT_GT(cv::countNonZero(matched), 0.75 * width * height);
    EXPECT_LT(cv::countNonZero(matched), width * height - 100);
    EXPECT_GT(countRight(image.disparity(hidden), pair.disparity(hidden)),
              0.9 * hidden.area());
  }
  const cv::Mat1f found = estimate("sgbm", pair.left, pair.right).disparity;
  EXPECT_LT(cv::countNonZero(found) - countRight(found, pair.disparity, 1.0),
            0.03 * width * height);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      ASSERT_LE(found(v, u), u) << "match outside, row " << v;
}

TEST(DisparityEngines, GiveTheSameForAnyNumberOfThreadsAndForColour)
{
  cv::Mat texture(150, 400, CV_8UC1), colours[2];
  cv::RNG(2).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {3, 3}, 0.0);
  const cv::Mat left = texture.colRange(0, 360).clone();
  const cv::Mat right = texture.colRange(21, 381).clone();
  cv::cvtColor(left, colours[0], cv::COLOR_GRAY2BGR);
  cv::cvtColor(right, colours[1], cv::COLOR_GRAY2BGR);
  for (const std::string& engine : disparityEngines()) {
    setNumberOfThreads(1);
    const DisparityImage expected = estimate(engine, left, right);
    for (const int threads : {2, 3, 8}) {
      setNumberOfThreads(threads);
      const DisparityImage found = estimate(engine, left, right);
      EXPECT_TRUE(isSameImage(found.disparity, expected.disparity)) << engine;
      EXPECT_TRUE(isSameImage(found.deviation, expected.deviation)) << engine;
    }
    setNumberOfThreads(0);
    EXPECT_TRUE(isSameImage(estimate(engine, colours[0], colours[1]).disparity,
                            expected.disparity))
        << engine;
  }
}

TEST(DisparityEngines, SeeNothingAroundAView)
{
  const Pair pair = makeSquare();
  const cv::Rect part(90, 20, 180, 80);
  const cv::Mat left = pair.left(part), right = pair.right(part);
  for (const std::string& engine : disparityEngines()) {
    const DisparityImage found = estimate(engine, left, right);
    const DisparityImage expected = estimate(engine, left.clone(), right.clone());
    EXPECT_TRUE(isSameImage(found.disparity, expected.disparity)) << engine;
    EXPECT_TRUE(isSameImage(found.deviation, expected.deviation)) << engine;
  }
}

TEST(DisparityEngines, TakeSmallAndBlankImages)
{
  for (const std::string& engine : disparityEngines())
    for (const int disparities : {64, engine == "sgm" ? 256 : 1024})
      for (const cv::Size size : {cv::Size(1, 1),
                                  {2, 2},
                                  {5, 3},
                                  {10, 7},
                                  {70, 2},
                                  {26, 23},
                                  {67, 64},
                                  {320, 120}}) {
        SCOPED_TRACE(engine + " " + std::to_string(size.width));
        const cv::Mat blank(size, CV_8UC1, cv::Scalar(90));
        const DisparityImage found = estimate(engine, blank, blank, disparities);
        EXPECT_EQ(found.disparity.size(), size);
        EXPECT_EQ(cv::countNonZero(found.disparity), 0) << "all disparities fit alike";
        EXPECT_TRUE(engine == "sgbm" || cv::countNonZero(found.deviation) == 0);
        cv::Mat noise(size, CV_8UC1);
        cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 256);
        EXPECT_EQ(estimate(engine, noise, noise, disparities).disparity.size(), size);
      }
}

TEST(DisparityEngines, RefuseImagesThatDoNotFit)
{
  const cv::Mat grey(20, 30, CV_8UC1, cv::Scalar(0)), deep(20, 30, CV_16UC1);
  const cv::Mat empty, wide(2, 16385, CV_8UC1, cv::Scalar(0));
  for (const std::string& engine : disparityEngines()) {
    for (const auto& [left, right] : {std::pair(empty, empty),
                                      {grey, empty},
                                      {grey, cv::Mat(20, 31, CV_8UC1)},
                                      {grey, cv::Mat(20, 30, CV_8UC3)},
                                      {deep, deep}})
      EXPECT_THROW(estimate(engine, left, right), BadInputException) << engine;
  }
  EXPECT_THROW(estimate("elas", wide, wide), BadInputException);
}

TEST(DisparityEngines, OthersAreRefused)
{
  EXPECT_EQ(thrownMessage<InvalidParameterException>(
                [] { makeDisparityEstimator("orb", 128); }),
            "the stereo engine is 'orb', expected sgm, elas or sgbm");
  for (const std::string& name : disparityEngines())
    for (const int disparities : {0, -64, 8, 100, 1088})
      expectBadParameter("disparities is " + std::to_string(disparities),
                         [&] { makeDisparityEstimator(name, disparities); });
  EXPECT_EQ(thrownMessage<InvalidParameterException>(
                [] { makeDisparityEstimator("sgm", 320); }),
            "semi-global matching: disparities is 320, expected 64, 128, 192 or 256");
}

TEST(DisparityEngines, MiddleburyCones)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "skipped: PCL_SEMANTIC_DATA is not set";
  const std::string folder = std::string(data) + "/middlebury_cones/";
  const cv::Mat left = readPng(folder + "im2.png", ImageKind::grey_or_colour);
  const cv::Mat right = readPng(folder + "im6.png", ImageKind::grey_or_colour);
  cv::Mat1f expected;
  readPng(folder + "disp2.png", ImageKind::labels).convertTo(expected, CV_32F, 0.25);
  for (const auto& [engine, min_valid, max_bad] :
       {std::tuple("elas", 1.0, 0.16), {"sgbm", 0.85, 0.07}}) {
    const cv::Mat1f found = estimate(engine, left, right).disparity;
    const cv::Mat known = expected > 0.0f, valid = known & (found > 0.0f);
    const cv::Mat bad = valid & (cv::abs(found - expected) > 1.0);
    EXPECT_GE(cv::countNonZero(valid), min_valid * cv::countNonZero(known)) << engine;
    EXPECT_LT(cv::countNonZero(bad), max_bad * cv::countNonZero(valid)) << engine;
  }
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

} // namespace
} // namespace pcl_semantic
