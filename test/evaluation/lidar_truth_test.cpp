// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_rigs.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/lidar_truth.h>

#include <gtest/gtest.h>

#include <random>

namespace pcl_semantic {

namespace {

struct Projected {
  int u = 0, v = 0;
  float z = 0.0f;
  Label label = 0;
};

/** \brief The rule of projectLidarTruth spelt out over pairs of returns. */
LidarTruth
bruteForce(const pcl::PointCloud<pcl::PointXYZI>& scan,
           const std::vector<Label>& labels, const StereoCamera& camera,
           const Eigen::Isometry3d& pose, const VisibilityParameters& parameters)
{
  std::vector<Projected> points;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3d p = pose * Eigen::Vector3d(scan[i].x, scan[i].y, scan[i].z);
    if (p.z() <= 0.1)
      continue;
    const double u = camera.fx * p.x() / p.z() + camera.cx;
    const double v = camera.fy * p.y() / p.z() + camera.cy;
    if (u < -0.5 || v < -0.5 || u >= camera.width - 0.5 || v >= camera.height - 0.5)
      continue;
    points.push_back(
        {int(std::floor(u + 0.5)), int(std::floor(v + 0.5)), float(p.z()), labels[i]});
  }
  cv::Mat1b truth(camera.height, camera.width, Label(0));
  cv::Mat1f depth(camera.height, camera.width, 0.0f);
  for (const Projected& p : points) {
    bool visible = p.z <= parameters.max_depth, above = false, below = false;
    for (const Projected& q : points) {
      if (q.u == p.u && q.v == p.v && q.z < p.z)
        visible = false;
      if (std::abs(q.u - p.u) <= parameters.window_columns &&
          std::abs(q.v - p.v) <= parameters.window_rows &&
          q.z < p.z - parameters.absolute_margin &&
          q.z < p.z - parameters.relative_margin * p.z) {
        above = above || q.v <= p.v;
        below = below || q.v >= p.v;
      }
    }
    if (visible && !(above && below)) {
      truth(p.v, p.u) = p.label;
      depth(p.v, p.u) = p.label ? p.z : 0.0f;
    }
  }
  return {truth, depth};
}

/** \brief The rule of seenDepths spelt out over pairs of returns. */
void
expectSeen(const pcl::PointCloud<pcl::PointXYZI>& scan, const Eigen::Isometry3d& pose,
           const VisibilityParameters& parameters)
{
  const StereoCamera camera = smallCamera();
  const std::vector<float> seen = seenDepths(scan, camera, pose, parameters);
  ASSERT_EQ(seen.size(), scan.size());
  int hidden = 0, visible = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3d p = pose * Eigen::Vector3d(scan[i].x, scan[i].y, scan[i].z);
    const auto pixel = pixelOf(p, camera);
    bool expected = pixel && p.z() <= parameters.max_depth, above = false,
         below = false;
    for (std::size_t j = 0; j < scan.size() && expected; ++j) {
      const Eigen::Vector3d q = pose * Eigen::Vector3d(scan[j].x, scan[j].y, scan[j].z);
      const auto other = pixelOf(q, camera);
      if (!other || std::abs(other->x() - pixel->x()) > parameters.window_columns ||
          std::abs(other->y() - pixel->y()) > parameters.window_rows ||
          q.z() >= p.z() - parameters.absolute_margin ||
          q.z() >= p.z() - parameters.relative_margin * p.z())
        continue;
      above = above || other->y() <= pixel->y();
      below = below || other->y() >= pixel->y();
    }
    hidden += expected && above && below;
    expected = expected && !(above && below);
    visible += expected;
    ASSERT_NEAR(seen[i], expected ? p.z() : 0.0, 1e-5) << i;
  }
  EXPECT_GT(hidden, 20);
  EXPECT_GT(visible, 100);
}

} // namespace

TEST(LidarTruth, EqualsBruteForce)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<float> side(-15.0f, 15.0f), ahead(-3.0f, 50.0f);
  std::uniform_int_distribution<int> label(0, 11);
  pcl::PointCloud<pcl::PointXYZI> scan;
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
  const LidarTruth expected = bruteForce(scan, labels, smallCamera(), pose, parameters);
  const cv::Mat1b truth = result.labels;
  EXPECT_EQ(cv::countNonZero(truth != expected.labels), 0);
  EXPECT_LT(cv::norm(result.depth, expected.depth, cv::NORM_INF), 1e-5);
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
  pcl::PointCloud<pcl::PointXYZI> scan;
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
  pcl::PointCloud<pcl::PointXYZI> scan;
  EXPECT_THROW(
      projectLidarTruth(scan, {1}, smallCamera(), Eigen::Isometry3d::Identity()),
      InvalidParameterException);
  EXPECT_THROW(
      projectLidarTruth(scan, {}, StereoCamera(), Eigen::Isometry3d::Identity()),
      InvalidParameterException);
}

} // namespace pcl_semantic
