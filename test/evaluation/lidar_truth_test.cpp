// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_rigs.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/lidar_truth.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <random>

namespace pcl_semantic {

namespace {

using Scan = pcl::PointCloud<pcl::PointXYZI>;

// A return in the image.
struct Projected {
  int u = 0, v = 0;
  double z = 0.0; // 0 = outside of it
};

std::vector<Projected>
project(const Scan& scan, const StereoCamera& camera, const Eigen::Isometry3d& pose)
{
  std::vector<Projected> points(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3d p = pose * Eigen::Vector3d(scan[i].x, scan[i].y, scan[i].z);
    const double u = camera.fx * p.x() / p.z() + camera.cx;
    const double v = camera.fy * p.y() / p.z() + camera.cy;
    if (p.z() > 0.1 && u >= -0.5 && v >= -0.5 && u < camera.width - 0.5 &&
        v < camera.height - 0.5)
      points[i] = {int(std::floor(u + 0.5)), int(std::floor(v + 0.5)), p.z()};
  }
  return points;
}

// Whether nearer returns lie on both sides of a point's row, spelt out over all pairs.
bool
isHidden(const Projected& p, const std::vector<Projected>& points,
         const VisibilityParameters& parameters)
{
  bool above = false, below = false;
  for (const Projected& q : points)
    if (q.z > 0.0 && std::abs(q.u - p.u) <= parameters.window_columns &&
        std::abs(q.v - p.v) <= parameters.window_rows &&
        q.z < p.z - parameters.absolute_margin &&
        q.z < p.z - parameters.relative_margin * p.z) {
      above = above || q.v <= p.v;
      below = below || q.v >= p.v;
    }
  return above && below;
}

void
expectSeen(const Scan& scan, const Eigen::Isometry3d& pose,
           const VisibilityParameters& parameters)
{
  const std::vector<Projected> points = project(scan, smallCamera(), pose);
  const std::vector<float> seen = seenDepths(scan, smallCamera(), pose, parameters);
  ASSERT_EQ(seen.size(), scan.size());
  int hidden = 0, visible = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const bool is_near = points[i].z > 0.0 && points[i].z <= parameters.max_depth;
    const bool is_hidden = is_near && isHidden(points[i], points, parameters);
    hidden += is_hidden;
    visible += is_near && !is_hidden;
    ASSERT_NEAR(seen[i], is_near && !is_hidden ? points[i].z : 0.0, 1e-5) << i;
  }
  EXPECT_GT(hidden, 20);
  EXPECT_GT(visible, 100);
}

void
expectProjected(const LidarTruth& result, const Scan& scan,
                const std::vector<Label>& labels, const Eigen::Isometry3d& pose,
                const VisibilityParameters& parameters)
{
  const std::vector<Projected> points = project(scan, smallCamera(), pose);
  cv::Mat1b truth(smallCamera().height, smallCamera().width, Label(0));
  cv::Mat1f depth(truth.size(), 0.0f);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Projected& p = points[i];
    const bool is_nearest =
        std::none_of(points.begin(), points.end(), [&](const Projected& q) {
          return q.z > 0.0 && q.u == p.u && q.v == p.v && float(q.z) < float(p.z);
        });
    if (p.z > 0.0 && p.z <= parameters.max_depth && is_nearest &&
        !isHidden(p, points, parameters)) {
      truth(p.v, p.u) = labels[i];
      depth(p.v, p.u) = labels[i] ? float(p.z) : 0.0f;
    }
  }
  EXPECT_EQ(cv::countNonZero(result.labels != truth), 0);
  EXPECT_LT(cv::norm(result.depth, depth, cv::NORM_INF), 1e-5);
}

} // namespace

TEST(LidarTruth, EqualsBruteForce)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<float> side(-15.0f, 15.0f), ahead(-3.0f, 50.0f);
  std::uniform_int_distribution<int> label(0, 11);
  Scan scan;
  std::vector<Label> labels;
  for (int i = 0; i < 1500; ++i) {
    pcl::PointXYZI point;
    point.x = ahead(random);
    point.y = side(random);
    point.z = side(random);
    scan.push_back(point);
    labels.push_back(static_cast<Label>(label(random)));
  }
  // Scanner: x forward, z up; slightly turned and behind the camera.
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(0.05, Eigen::Vector3d(1, 2, 3).normalized()) * axes;
  pose.translation() << 0.06, -0.08, -0.3;
  VisibilityParameters parameters;
  parameters.window_rows = 4;
  parameters.window_columns = 2;
  const LidarTruth result =
      projectLidarTruth(scan, labels, smallCamera(), pose, parameters);
  const cv::Mat1b truth = result.labels;
  expectProjected(result, scan, labels, pose, parameters);
  expectSeen(scan, pose, parameters);
  parameters.absolute_margin = 1e9; // no occlusion rule
  const int all = cv::countNonZero(
      projectLidarTruth(scan, labels, smallCamera(), pose, parameters).labels);
  EXPECT_GT(cv::countNonZero(truth), 100);
  EXPECT_GT(all, cv::countNonZero(truth) + 50);
}

TEST(LidarTruth, BackgroundShinesThroughOnlyBesideTheObject)
{
  // Returns as pixels with depth, scanner = camera.
  const StereoCamera camera = smallCamera();
  Scan scan;
  std::vector<Label> labels;
  const auto add = [&](int u, int v, double depth, Label label) {
    pcl::PointXYZI point;
    point.getVector3fMap() = camera.unproject(u, v, depth).cast<float>();
    scan.push_back(point);
    labels.push_back(label);
  };
  for (int v = 10; v <= 30; v += 5) // a car ...
    for (int u = 20; u <= 40; u += 2)
      add(u, v, 8.0, 6);
  add(31, 22, 25.0, 1); // ... the wall between its beams,
  add(31, 7, 25.0, 1);  // above its roof
  add(60, 22, 25.0, 1); // and beside it
  add(70, 22, 41.0, 1); // too far
  add(20, 10, 9.0, 1);  // on a pixel of the car, farther
  add(10, 10, 5.0, 0);  // unlabelled, hides what is behind it
  add(10, 10, 9.0, 1);
  for (int v = 30; v < 50; ++v) // a road rises towards the horizon
    for (int u = 50; u < 80; ++u)
      add(u, v, 50.0 * 1.65 / (v - 25.3), 3);
  const cv::Mat1b truth =
      projectLidarTruth(scan, labels, camera, Eigen::Isometry3d::Identity()).labels;
  EXPECT_EQ(truth(20, 20), 6);
  EXPECT_EQ(truth(22, 31), 0);
  EXPECT_EQ(truth(7, 31), 1);
  EXPECT_EQ(truth(22, 60), 1);
  EXPECT_EQ(truth(22, 70), 0);
  EXPECT_EQ(truth(10, 20), 6);
  EXPECT_EQ(truth(10, 10), 0);
  EXPECT_EQ(cv::countNonZero(truth == 3), 20 * 30);
}

TEST(LidarTruth, RefusesWrongSizes)
{
  Scan scan;
  EXPECT_THROW(
      projectLidarTruth(scan, {1}, smallCamera(), Eigen::Isometry3d::Identity()),
      InvalidParameterException);
  EXPECT_THROW(
      projectLidarTruth(scan, {}, StereoCamera(), Eigen::Isometry3d::Identity()),
      InvalidParameterException);
}

} // namespace pcl_semantic
