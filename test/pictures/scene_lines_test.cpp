// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/pictures/scene_lines.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pcl_semantic {

namespace {

// A camera in the origin that looks along z; a point (x, y, 1) is at pixel
// (100 x + 50, 100 y + 40).
SceneView
plainView()
{
  SceneView view;
  view.camera.fx = view.camera.fy = 100.0;
  view.camera.cx = 50.0;
  view.camera.cy = 40.0;
  view.camera.width = 101;
  view.camera.height = 81;
  view.T_world_camera = Eigen::Isometry3d::Identity();
  return view;
}

// Number of pixels that are not white.
int
painted(const cv::Mat& picture)
{
  int count = 0;
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column)
      count += picture.at<cv::Vec3b>(row, column) != cv::Vec3b(255, 255, 255);
  return count;
}

} // namespace

TEST(SceneLines, ALineInsideTheImageKeepsItsEnds)
{
  const auto line = projectLine(plainView(), {-0.2, 0.1, 1.0}, {0.4, 0.2, 2.0});
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->first.isApprox(Eigen::Vector3d(30.0, 50.0, 1.0)));
  EXPECT_TRUE(line->second.isApprox(Eigen::Vector3d(70.0, 50.0, 2.0)));
}

TEST(SceneLines, ALineEndsAtTheBorderAndBeforeTheCamera)
{
  const SceneView view = plainView();
  const auto across = projectLine(view, {-3.0, 0.0, 1.0}, {3.0, 0.0, 1.0});
  ASSERT_TRUE(across);
  EXPECT_NEAR(across->first.x(), 0.0, 1e-9);
  EXPECT_NEAR(across->second.x(), 100.0, 1e-9);
  const auto ahead = projectLine(view, {0.0, 0.0, -5.0}, {0.0, 0.0, 5.0});
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(ahead->first.z(), 0.1, 1e-9);
  EXPECT_EQ(ahead->second.z(), 5.0);
  EXPECT_FALSE(projectLine(view, {0.0, 0.0, -5.0}, {1.0, 0.0, -1.0})) << "behind";
  EXPECT_FALSE(projectLine(view, {2.0, 0.0, 1.0}, {2.0, 1.0, 1.0})) << "beside";
  EXPECT_FALSE(projectLine(view, {1.0, 0.0, 1.0}, {0.0, 2.0, 1.0})) << "at a corner";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(projectLine(view, {nan, 0.0, 1.0}, {0.0, 0.0, 1.0}));
}

TEST(SceneLines, PartsBehindASurfaceAreLeftOut)
{
  const SceneView view = plainView();
  const std::vector<SceneLine> lines = {
      {{-0.4, 0.0, 1.0}, {0.4, 0.0, 1.0}, cv::Vec3b(200, 0, 0)}};
  const auto draw = [&](const cv::Mat& depth) {
    cv::Mat picture(81, 101, CV_8UC3, cv::Scalar::all(255));
    drawLines(picture, depth, view, lines, 0.25, 1);
    return painted(picture);
  };
  cv::Mat depth = cv::Mat::zeros(81, 101, CV_64FC1); // no surface
  const int whole = draw(depth);
  EXPECT_GE(whole, 80);
  depth.colRange(0, 50) = 0.5;            // before the left half
  EXPECT_NEAR(draw(depth), whole / 2, 8); // and the ends of the borders
  depth.colRange(0, 50) = 0.8;            // within the margin
  EXPECT_EQ(draw(depth), whole);
}

TEST(SceneLines, ABoxHasTwelveEdges)
{
  LabelClass car;
  car.name = "car";
  car.colour = {10, 20, 30};
  ObjectSummary object = summarizeObject({{0.0, 0.0, 0.0}, {4.0, 2.0, 1.5}, {4, 0, 0}});
  object.label = 1;
  const auto lines = boxLines({object}, LabelSet({car}), {1.0, 0.0, 0.0});
  ASSERT_EQ(lines.size(), 12u);
  double length = 0.0;
  for (const SceneLine& line : lines) {
    length += (line.to - line.from).norm();
    EXPECT_EQ(line.colour, cv::Vec3b(30, 20, 10));
    EXPECT_GE(line.from.x(), -1.0 - 1e-9);
    EXPECT_LE(line.from.x(), 3.0 + 1e-9);
  }
  EXPECT_NEAR(length, 4.0 * (4.0 + 2.0 + 1.5), 1e-6);
}

} // namespace pcl_semantic
