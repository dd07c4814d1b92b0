// SPDX-License-Identifier: BSD-3-Clause
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/stereo/disparity_to_cloud.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <limits>

namespace pcl_semantic {
namespace {

constexpr int width = 7;
constexpr int height = 5;

StereoCamera
makeCamera()
{
  StereoCamera camera;
  camera.fx = 718.9;
  camera.fy = 720.1;
  camera.cx = 3.2;
  camera.cy = 1.9;
  camera.baseline = 0.537;
  camera.width = width;
  camera.height = height;
  return camera;
}

cv::Mat
makeDisparity()
{
  cv::Mat disparity(height, width, CV_32FC1);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      disparity.at<float>(v, u) =
          (u + v) % 4 == 0 ? 0.0f : 0.5f + 3.25f * u + 0.0625f * v;
  return disparity;
}

cv::Mat
makeImage()
{
  cv::Mat image(height, width, CV_8UC3);
  cv::RNG(3).fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

TEST(DisparityToCloud, PointsProjectBackToTheirPixelAndDisparity)
{
  const StereoCamera camera = makeCamera();
  const cv::Mat disparity = makeDisparity();
  const cv::Mat image = makeImage();
  const auto cloud = disparityToCloud(disparity, image, camera);
  ASSERT_EQ(cloud->width, unsigned(width));
  ASSERT_EQ(cloud->height, unsigned(height));
  EXPECT_FALSE(cloud->is_dense);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const pcl::PointXYZRGB& point = cloud->at(u, v);
      const cv::Vec3b bgr = image.at<cv::Vec3b>(v, u);
      EXPECT_EQ(point.r, bgr[2]);
      EXPECT_EQ(point.g, bgr[1]);
      EXPECT_EQ(point.b, bgr[0]);
      const double d = disparity.at<float>(v, u);
      if (d == 0.0) {
        EXPECT_TRUE(std::isnan(point.x) && std::isnan(point.y) && std::isnan(point.z));
        continue;
      }
      // The pixel in the left image, and where the right camera sees the point.
      EXPECT_NEAR(camera.fx * point.x / point.z + camera.cx, u, 1e-3);
      EXPECT_NEAR(camera.fy * point.y / point.z + camera.cy, v, 1e-3);
      EXPECT_NEAR(camera.fx * (point.x - camera.baseline) / point.z + camera.cx, u - d,
                  1e-3);
    }
}

TEST(DisparityToCloud, DeviationsAreThoseOfAShiftedDisparity)
{
  const StereoCamera camera = makeCamera();
  const auto cloud = disparityToCloud(makeDisparity(), makeImage(), camera);
  cv::Mat deviation(height, width, CV_32FC1);
  cv::RNG(7).fill(deviation, cv::RNG::UNIFORM, 0.002, 0.01);
  const std::vector<float> deviations =
      distanceDeviations(*cloud, camera, deviation, 2.0);
  ASSERT_EQ(deviations.size(), cloud->size());
  const auto shifted =
      disparityToCloud(makeDisparity() + 2.0 * deviation, makeImage(), camera);
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const Eigen::Vector3f point = (*cloud)[i].getVector3fMap();
    if (!point.allFinite())
      EXPECT_EQ(deviations[i], 0.0f);
    else
      EXPECT_NEAR(deviations[i], (point - (*shifted)[i].getVector3fMap()).norm(),
                  0.03f * deviations[i]);
  }
}

TEST(DisparityToCloud, DeviationsOfAnotherImageAreRefused)
{
  const auto cloud = disparityToCloud(makeDisparity(), makeImage(), makeCamera());
  for (const cv::Mat& deviation : {cv::Mat(height, width - 1, CV_32FC1),
                                   cv::Mat(height, width, CV_64FC1), cv::Mat()})
    EXPECT_THROW(distanceDeviations(*cloud, makeCamera(), deviation),
                 BadInputException);
  for (const std::uint32_t columns : {0u, 1u, 1000u}) { // points.push_back() sets none
    pcl::PointCloud<pcl::PointXYZRGB> other = *cloud;
    other.width = columns;
    EXPECT_THROW(imageOfCloud(other), InvalidParameterException);
    EXPECT_THROW(distanceDeviations(other, makeCamera(), cv::Mat()),
                 InvalidParameterException);
  }
  const cv::Mat1f deviation(height, width, 1.0f);
  for (const double scale : {-1.0, std::nan("")})
    EXPECT_THROW(distanceDeviations(*cloud, makeCamera(), deviation, scale),
                 InvalidParameterException);
}

TEST(DisparityToCloud, GreyImage)
{
  cv::Mat image(height, width, CV_8UC1);
  cv::RNG(4).fill(image, cv::RNG::UNIFORM, 0, 256);
  const auto cloud = disparityToCloud(makeDisparity(), image, makeCamera());
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const pcl::PointXYZRGB& point = cloud->at(u, v);
      const std::uint8_t grey = image.at<std::uint8_t>(v, u);
      EXPECT_TRUE(point.r == grey && point.g == grey && point.b == grey);
    }
}

TEST(DisparityToCloud, RefusesWhatDoesNotFit)
{
  const StereoCamera camera = makeCamera();
  const cv::Mat disparity = makeDisparity();
  const cv::Mat image = makeImage();
  for (const auto& [first, second] : {std::pair(cv::Mat(), cv::Mat()),
                                      {disparity, cv::Mat()},
                                      {disparity, image.colRange(1, width)},
                                      {image, image},
                                      {disparity, disparity}})
    EXPECT_THROW(disparityToCloud(first, second, camera), BadInputException);
  StereoCamera other = camera;
  other.height = height + 1;
  EXPECT_THROW(disparityToCloud(disparity, image, other), BadInputException);
  other = camera;
  other.baseline = 0.0;
  EXPECT_THROW(disparityToCloud(disparity, image, other), InvalidParameterException);
}

TEST(DisparityToCloud, RefusesNegativeAndNonFiniteDisparities)
{
  for (const float value : {-1.0f, std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN()}) {
    cv::Mat disparity = makeDisparity();
    disparity.at<float>(2, 3) = value;
    expectBadInput("(3, 2)",
                   [&] { disparityToCloud(disparity, makeImage(), makeCamera()); });
  }
}

} // namespace
} // namespace pcl_semantic
