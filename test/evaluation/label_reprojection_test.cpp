// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/labelling/visible_points.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

namespace pcl_semantic {

namespace {

StereoCamera
smallCamera()
{
  StereoCamera camera;
  camera.fx = 45.0;
  camera.fy = 50.0;
  camera.cx = 31.3;
  camera.cy = 19.7;
  camera.baseline = 0.5;
  camera.width = 64;
  camera.height = 41;
  return camera;
}

VoxelCloud
makeVoxels(const std::vector<VoxelIndex>& indices, double voxel_size)
{
  VoxelCloud voxels;
  voxels.voxel_size = voxel_size;
  voxels.indices = indices;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    pcl::PointXYZRGBL point;
    point.label = 1 + static_cast<std::uint32_t>(i) % 11;
    voxels.cloud->push_back(point);
  }
  voxels.moveToCentres();
  return voxels;
}

/** \brief The rule of renderSplats() for each pixel and all voxels, in double
 * precision. Pixels that are nearly even get a depth of -1. */
RenderedLabels
bruteForce(const VoxelCloud& voxels, const StereoCamera& camera,
           const Eigen::Isometry3d& pose, double max_depth)
{
  RenderedLabels result{cv::Mat::zeros(camera.height, camera.width, CV_8UC1),
                        cv::Mat::zeros(camera.height, camera.width, CV_32FC1),
                        cv::Mat(camera.height, camera.width, CV_32SC1, cv::Scalar(-1))};
  const double radius = 0.87 * voxels.voxel_size;
  std::map<double, std::size_t> by_depth; // voxels in view
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Eigen::Vector3d point = (*voxels.cloud)[i].getVector3fMap().cast<double>();
    const double z = (pose.inverse() * point).z();
    if (z - radius >= 0.1 && z <= max_depth)
      by_depth[z] = i;
  }
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray =
          pose.linear() * camera.unproject(u, v, 1.0).normalized();
      double light = 1.0, first = std::numeric_limits<double>::infinity();
      bool is_close_call = false;
      std::map<std::uint32_t, double> sums;
      std::map<std::uint32_t, std::pair<double, std::size_t>> best;
      for (const auto& [z, i] : by_depth) {
        const Eigen::Vector3d offset =
            (*voxels.cloud)[i].getVector3fMap().cast<double>() - pose.translation();
        const double distance = (offset - offset.dot(ray) * ray).norm();
        const double scans = voxels.observations.empty() ? 1 : voxels.observations[i];
        const double inside =
            std::max(1.0 - distance * distance / (radius * radius), 0.0);
        const double opacity =
            scans * scans / (scans * scans + 2.0) * std::pow(inside, 5.0);
        for (const double limit : {1e-5, 0.05})
          is_close_call |= std::abs(opacity / limit - 1.0) < 0.01;
        if (!(opacity > 1e-5) || z > first + 1.0)
          continue;
        if (opacity > 0.05)
          first = std::min(first, z);
        const std::uint32_t label = (*voxels.cloud)[i].label;
        sums[label] += light * opacity;
        if (light * opacity > best[label].first)
          best[label] = {light * opacity, i};
        light -= light * opacity;
      }
      if (sums.empty() && !is_close_call)
        continue;
      std::uint32_t winner = 0;
      double most = 0.0, second = 0.0;
      for (const auto& [label, sum] : sums)
        if (label > 0 && sum > most) {
          second = most;
          most = sum;
          winner = label;
        }
        else if (label > 0)
          second = std::max(second, sum);
      if (is_close_call || most - second < 1e-3 * most) {
        result.depth.at<float>(v, u) = -1.0f;
        continue;
      }
      const std::size_t shown = best[winner].second;
      result.labels.at<Label>(v, u) = Label(winner);
      result.indices.at<std::int32_t>(v, u) = std::int32_t(shown);
      result.depth.at<float>(v, u) = float(
          (pose.inverse() * (*voxels.cloud)[shown].getVector3fMap().cast<double>())
              .z());
    }
  return result;
}

void
expectEqual(const RenderedLabels& result, const RenderedLabels& expected)
{
  const cv::Mat is_sure = expected.depth >= 0.0f;
  EXPECT_LT(cv::countNonZero(expected.depth < 0.0f), 20);
  EXPECT_EQ(cv::countNonZero((result.labels != expected.labels) & is_sure), 0);
  EXPECT_LT(cv::norm(result.depth, expected.depth, cv::NORM_INF, is_sure), 1e-5);
}

/** \brief A camera that looks along the world's x axis, z up. */
Eigen::Isometry3d
forwardPose()
{
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return pose;
}

} // namespace

TEST(RenderLabels, EqualsBruteForceFromAnywhere)
{
  std::mt19937 random(3);
  std::uniform_int_distribution<int> index(-25, 25);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  std::set<VoxelIndex, VoxelIndexLess> indices;
  while (indices.size() < 300)
    indices.insert(VoxelIndex(index(random), index(random), index(random)));
  VoxelCloud voxels = makeVoxels({indices.begin(), indices.end()}, 0.2);
  for (auto& point : *voxels.cloud)
    for (int axis = 0; axis < 3; ++axis)
      point.data[axis] += float(0.099 * number(random)); // anywhere in its voxel
  for (std::size_t i = 0; i < voxels.size(); ++i)
    voxels.observations.push_back(1 + random() % 9);
  for (int trial = 0; trial < 12; ++trial) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const Eigen::Vector4d turn(number(random), number(random), number(random), 0.2);
    pose.linear() = Eigen::Quaterniond(turn.normalized()).matrix();
    for (int axis = 0; axis < 3; ++axis)
      pose.translation()[axis] = 3.0 * number(random);
    const double max_depth = trial % 2 ? 4.0 : 100.0;
    const RenderedLabels result = renderLabels(voxels, smallCamera(), pose, max_depth);
    expectEqual(result, bruteForce(voxels, smallCamera(), pose, max_depth));
  }
  // Seen from afar, where many rays hit something.
  Eigen::Isometry3d pose = forwardPose();
  pose.translation() << -9.0, 0.013, -0.027; // no ray along an edge
  const RenderedLabels result = renderLabels(voxels, smallCamera(), pose, 100.0);
  EXPECT_GT(cv::countNonZero(result.labels), 30);
  expectEqual(result, bruteForce(voxels, smallCamera(), pose, 100.0));
}

TEST(RenderLabels, DoesNotDependOnTheOrderOfVoxels)
{
  std::mt19937 random(5);
  std::uniform_int_distribution<int> index(-12, 12);
  std::set<VoxelIndex, VoxelIndexLess> indices;
  while (indices.size() < 200)
    indices.insert(VoxelIndex(20 + index(random), index(random), index(random)));
  VoxelCloud voxels = makeVoxels({indices.begin(), indices.end()}, 0.1);
  const RenderedLabels one = renderLabels(voxels, smallCamera(), forwardPose(), 40.0);
  std::reverse(voxels.indices.begin(), voxels.indices.end());
  std::reverse(voxels.cloud->begin(), voxels.cloud->end());
  const RenderedLabels other = renderLabels(voxels, smallCamera(), forwardPose(), 40.0);
  EXPECT_EQ(cv::countNonZero(one.labels != other.labels), 0);
  EXPECT_EQ(cv::countNonZero(one.depth != other.depth), 0);
}

// A pole before a wall: half-transparent where it is thin, and outvoted at its border.
TEST(RenderLabels, ClassesVoteAndTheVoxelWithTheLargestWeightIsShown)
{
  StereoCamera camera = smallCamera();
  camera.cx = 32.0;
  camera.cy = 20.0;
  camera.fx = camera.fy = 100.0;
  VoxelCloud voxels = makeVoxels({{40, 0, 0}, {43, 0, 0}, {45, 0, 0}, {56, 0, 0}}, 0.1);
  for (pcl::PointXYZRGBL& point : *voxels.cloud)
    point.y = point.z = 0.0f; // along the ray of the pixel in the middle
  const auto shown = [&] {
    const RenderedLabels seen = renderLabels(voxels, camera, forwardPose(), 40.0);
    return std::pair(int(seen.labels.at<Label>(20, 32)),
                     seen.indices.at<std::int32_t>(20, 32));
  };
  const auto setLabels = [&](std::array<std::uint32_t, 4> labels) {
    for (std::size_t i = 0; i < 4; ++i)
      (*voxels.cloud)[i].label = labels[i];
  };
  // Weights 0.33, 0.22, 0.15; the last is more than 1 m behind the first.
  setLabels({1, 2, 3, 2});
  EXPECT_EQ(shown(), std::pair(1, 0));
  setLabels({1, 2, 2, 1});
  EXPECT_EQ(shown(), std::pair(2, 1));
  voxels.observations = {2, 2, 1, 9}; // 0.67, 0.22, 0.04
  EXPECT_EQ(shown(), std::pair(1, 0));
  (*voxels.cloud)[0].y = 0.05f; // 0.13 of its opacity
  EXPECT_EQ(shown(), std::pair(2, 1));
  voxels.observations.clear();
  setLabels({0, 0, 3, 4}); // the unlabelled ones do not win
  EXPECT_EQ(shown(), std::pair(3, 2));
  setLabels({0, 0, 0, 4});
  EXPECT_EQ(shown().first, 0);
  EXPECT_GE(shown().second, 0);
}

TEST(RenderLabels, DepthLimitsAndFarFromTheOrigin)
{
  Eigen::Isometry3d pose = forwardPose();
  const auto seen = [&](const VoxelIndex& voxel, double max_depth) {
    VoxelCloud voxels = makeVoxels({voxel}, 0.1);
    voxels.origin = centreOf(voxel, 0.1);
    voxels.moveToCentres();
    return cv::countNonZero(renderLabels(voxels, smallCamera(), pose, max_depth).depth);
  };
  EXPECT_GT(seen({10, 0, 0}, 1.0501), 0); // its point lies at 1.05 m
  EXPECT_EQ(seen({10, 0, 0}, 1.0499), 0);
  EXPECT_GT(seen({2, 0, 0}, 40.0), 0);   // reaches to 0.18 m
  EXPECT_EQ(seen({1, 0, 0}, 40.0), 0);   // to 0.08 m
  EXPECT_EQ(seen({-10, 0, 0}, 40.0), 0); // behind the camera
  const int near = seen({30, 1, 2}, 40.0);
  EXPECT_GT(near, 0);
  pose.translation() << 1e5, -1e5, 100.0;
  EXPECT_EQ(seen({1000030, -999999, 1002}, 40.0), near);
}

// Of 300 the label 44 would be left.
TEST(RenderLabels, ALabelHasEightBits)
{
  VoxelCloud voxels = makeVoxels({{10, 0, 0}}, 0.1);
  (*voxels.cloud)[0].label = 300;
  EXPECT_THROW(renderLabels(voxels, smallCamera(), forwardPose(), 40.0),
               BadInputException);
  voxels.measured = LabelDistributions(2, 1);
  EXPECT_THROW(MapLabels{voxels}, BadInputException);
}

// Rows of points that are not there would be read.
TEST(LabelsAtDepth, NeedsTheSizeOfTheCloud)
{
  const SemanticVoxelMap map(LabelSet({{"road", {}}, {"car", {}}}), {});
  pcl::PointCloud<pcl::PointXYZRGB> cloud(4, 3);
  const auto look = [&] {
    return labelsAtDepth(map, cloud, Eigen::Isometry3d::Identity(), 40.0);
  };
  EXPECT_EQ(look().size(), cv::Size(4, 3));
  for (const std::uint32_t width : {3u, 5u}) {
    cloud.width = width;
    EXPECT_THROW(look(), InvalidParameterException);
  }
}

TEST(RenderLabels, PosesAreRigid)
{
  const SemanticVoxelMap map(LabelSet({{"road", {}}, {"car", {}}}), {});
  const pcl::PointCloud<pcl::PointXYZRGB> cloud(2, 2);
  Eigen::Isometry3d scaled = Eigen::Isometry3d::Identity(), transposed = scaled;
  scaled.linear() *= 2.0;
  transposed.matrix()(3, 0) = 5.0;
  for (const Eigen::Isometry3d& pose : {scaled, transposed}) {
    EXPECT_THROW(renderLabels(VoxelCloud(), smallCamera(), pose, 40.0),
                 BadInputException);
    EXPECT_THROW(labelsAtDepth(map, cloud, pose, 40.0), BadInputException);
    EXPECT_THROW(pointsInCamera(cloud, pose), BadInputException);
  }
}

TEST(RenderLabels, EmptyAndInvalid)
{
  const RenderedLabels result =
      renderLabels(VoxelCloud(), smallCamera(), forwardPose(), 40.0);
  EXPECT_EQ(result.labels.size(), cv::Size(64, 41));
  EXPECT_EQ(cv::countNonZero(result.labels), 0);
  VoxelCloud voxels = makeVoxels({{10, 0, 0}}, 0.1);
  EXPECT_THROW(renderLabels(voxels, smallCamera(), forwardPose(), 0.0),
               InvalidParameterException);
  EXPECT_THROW(renderLabels(voxels, StereoCamera(), forwardPose(), 40.0),
               InvalidParameterException);
  voxels.indices.push_back({1, 2, 3});
  EXPECT_THROW(renderLabels(voxels, smallCamera(), forwardPose(), 40.0),
               InvalidParameterException);
}

} // namespace pcl_semantic
