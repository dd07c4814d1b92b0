// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_rigs.h"
#include "support/thrown_message.h"

#include <pcl_semantic/dataset/rectifier.h>

#include <opencv2/calib3d.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace pcl_semantic {

namespace {

// An image whose pixels hold their own coordinates: rectified, it tells where each
// pixel comes from.
cv::Mat2f
coordinates(int width, int height)
{
  cv::Mat2f image(height, width);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image(y, x) = cv::Vec2f(float(x), float(y));
  return image;
}

Eigen::Vector2d
sample(const cv::Mat2f& image, const Eigen::Vector2d& at)
{
  const int x = int(at.x()), y = int(at.y());
  const double a = at.x() - x, b = at.y() - y;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const cv::Vec2f value =
          image(std::min(y + j, image.rows - 1), std::min(x + i, image.cols - 1));
      sum += (i ? a : 1 - a) * (j ? b : 1 - b) * Eigen::Vector2d(value[0], value[1]);
    }
  return sum;
}

// What OpenCV's model of a camera says: the pixel of a point in the camera's frame.
Eigen::Vector2d
project(const Eigen::Vector3d& point, const Eigen::Matrix3d& K,
        const std::vector<double>& D, bool is_fisheye)
{
  cv::Mat matrix;
  cv::eigen2cv(K, matrix);
  std::vector<cv::Point2d> pixels;
  const std::vector<cv::Point3d> points = {{point.x(), point.y(), point.z()}};
  if (is_fisheye)
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(), cv::Vec3d(), matrix, D);
  else
    cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), matrix, D, pixels);
  return {pixels[0].x, pixels[0].y};
}

// Whether the pixels around a place are all of the image.
bool
isInside(const Eigen::Vector2d& at, const StereoRig& rig)
{
  return at.minCoeff() > 1.0 && at.x() < rig.width - 2 && at.y() < rig.height - 2;
}

// EXPECTs that points at random pixels and depths of the rectified pair are seen by the
// rig's cameras where the rectified images take their pixels from.
void
expectPointsMeet(const StereoRig& rig)
{
  const Rectifier rectifier(rig);
  const StereoCamera& camera = rectifier.camera();
  const cv::Mat2f own = coordinates(rig.width, rig.height);
  const cv::Mat2f left = rectifier.rectify(own, StereoSide::left);
  const cv::Mat2f right = rectifier.rectify(own, StereoSide::right);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> columns(0, rig.width - 1),
      rows(0, rig.height - 1);
  double worst = 0.0;
  int seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const double u = columns(random), v = rows(random);
    const Eigen::Vector2d pixel(u, v);
    const double disparity =
        std::uniform_real_distribution<double>(0.01, 1.0)(random) * pixel.x();
    const Eigen::Vector3d point =
        camera.unproject(pixel.x(), pixel.y(), camera.depth(disparity));
    const Eigen::Vector3d in_left = rectifier.T_left_rectified() * point;
    const Eigen::Vector3d in_right = rig.R * in_left + rig.T;
    const Eigen::Vector2d partner = pixel - Eigen::Vector2d(disparity, 0.0);
    const Eigen::Vector2d own_left = project(in_left, rig.K1, rig.D1, rig.is_fisheye);
    const Eigen::Vector2d own_right = project(in_right, rig.K2, rig.D2, rig.is_fisheye);
    if (!isInside(own_left, rig) || !isInside(own_right, rig))
      continue; // black comes from there
    ++seen;
    worst = std::max({worst, (sample(left, pixel) - own_left).norm(),
                      (sample(right, partner) - own_right).norm()});
  }
  EXPECT_GT(seen, 1900);
  EXPECT_LT(worst, 0.05) << "px";
}

} // namespace

TEST(Rectifier, PointsMeetInOneRowAtTheirDisparity)
{
  StereoRig rig = exampleRig();
  expectPointsMeet(rig);
  rig.D1 = {-0.28, 0.09, 0.0, 0.0};
  rig.D2 = {0.3, -0.1, 0.001, 0.002, 0.02, 0.55, -0.05, 0.01};
  expectPointsMeet(rig);
  rig.D1.assign(14, 0.0);
  rig.D1[0] = -0.2;
  rig.D1[12] = 0.02; // a tilted sensor
  rig.D2 = {-0.2, 0.05, 0, 0, 0, 0, 0, 0, 0.002, -0.001, 0.001, 0.0005};
  expectPointsMeet(rig);
}

TEST(Rectifier, FisheyesMeetInOneRow)
{
  StereoRig rig = exampleRig();
  rig.is_fisheye = true;
  rig.D1 = {-0.02, -0.007, 0.002, -0.001};
  rig.D2 = {-0.0197, -0.005, -0.0014, 0.0004};
  expectPointsMeet(rig);
  rig.D1.assign(4, 0.0); // equidistant without coefficients is no pinhole
  rig.D2.assign(4, 0.0);
  expectPointsMeet(rig);
  rig.D1.push_back(0.0);
  EXPECT_THROW(Rectifier{rig}, InvalidParameterException);
}

TEST(Rectifier, TheBaselineLiesAlongTheRows)
{
  const StereoRig rig = exampleRig();
  const Rectifier rectifier(rig);
  const StereoCamera& camera = rectifier.camera();
  EXPECT_EQ(camera.width, 640);
  EXPECT_EQ(camera.height, 480);
  EXPECT_DOUBLE_EQ(camera.fx, camera.fy);
  EXPECT_NEAR(camera.baseline, 0.12, 1e-9);
  const Eigen::Vector3d right_centre = -rig.R.transpose() * rig.T;
  EXPECT_TRUE((rectifier.T_left_rectified() * Eigen::Vector3d(camera.baseline, 0, 0))
                  .isApprox(right_centre, 1e-9));
  // The cameras were turned by some degrees; neither is turned by more.
  const Eigen::AngleAxisd turn(rectifier.T_left_rectified().linear());
  EXPECT_GT(turn.angle(), 0.005);
  EXPECT_LT(turn.angle(), 0.1);
}

TEST(Rectifier, HardlyAPixelComesFromOutside)
{
  const StereoRig rig = exampleRig();
  const Rectifier rectifier(rig);
  const cv::Mat1b white(480, 640, std::uint8_t(255));
  for (const StereoSide side : {StereoSide::left, StereoSide::right}) {
    const cv::Mat1b rectified = rectifier.rectify(white, side);
    EXPECT_LT(cv::countNonZero(rectified < 255), 640 * 480 / 1000);
  }
  const cv::Mat colour(480, 640, CV_8UC3, cv::Scalar(10, 20, 30));
  const cv::Mat3b rectified = rectifier.rectify(colour, StereoSide::right);
  EXPECT_EQ(rectified(240, 320), cv::Vec3b(10, 20, 30));
}

TEST(Rectifier, WhatIsRectifiedStaysAsItIs)
{
  StereoRig rig = exampleRig();
  rig.K2 = rig.K1;
  rig.D1.assign(5, 0.0);
  rig.D2.assign(5, 0.0);
  rig.R.setIdentity();
  rig.T << -0.12, 0, 0;
  const cv::Mat2f own = coordinates(640, 480);
  const Rectifier same(rig);
  EXPECT_DOUBLE_EQ(same.camera().fx, rig.K1(0, 0));
  EXPECT_DOUBLE_EQ(same.camera().fy, rig.K1(1, 1));
  EXPECT_DOUBLE_EQ(same.camera().cx, rig.K1(0, 2));
  EXPECT_DOUBLE_EQ(same.camera().baseline, 0.12);
  EXPECT_TRUE(same.T_left_rectified().matrix().isIdentity());
  EXPECT_EQ(cv::norm(same.rectify(own, StereoSide::right), own, cv::NORM_INF), 0.0);

  // Next to rectified: through the maps, and next to unchanged.
  rig.K1(1, 1) = rig.K1(0, 0); // they give both directions one focal length
  rig.K2 = rig.K1;
  rig.D1[0] = 1e-9;
  expectPointsMeet(rig);
  const Rectifier nearly(rig);
  EXPECT_NEAR(nearly.camera().fx, rig.K1(0, 0), 2.0);
  for (const StereoSide side : {StereoSide::left, StereoSide::right})
    EXPECT_LT(cv::norm(nearly.rectify(own, side), own, cv::NORM_INF), 1.5);
}

TEST(Rectifier, RefusesWhatItCannotRectify)
{
  using Change = std::function<void(StereoRig&)>;
  for (const auto& [says, change] : std::vector<std::pair<std::string, Change>>{
           {"image size: is not known", [](auto& r) { r.width = r.height = 0; }},
           {"T: is (0, 0, 0): the baseline is 0 m", [](auto& r) { r.T.setZero(); }},
           {"left image can be rectified; check K, D", // it folds
            [](auto& r) { r.D1[0] = -40.0; }}}) {
    StereoRig rig = exampleRig();
    change(rig);
    expectBadParameter(says, [&] { Rectifier{rig}; });
  }
  const Rectifier rectifier(exampleRig());
  expectBadParameter("image has 641 x 480 pixels, expected 640 x 480",
                     [&] { rectifier.rectify(cv::Mat1b(480, 641), StereoSide::left); });
}

} // namespace pcl_semantic
