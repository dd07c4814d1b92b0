// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/voxel_lookup.h>
#include <pcl_semantic/labelling/visible_points.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <algorithm>
#include <limits>
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

/** \brief All voxels for each pixel, by where the ray crosses the faces, of which those
 * with no voxel on their other side lie 0.2 voxels from the point. */
RenderedLabels
bruteForce(const VoxelCloud& voxels, const StereoCamera& camera,
           const Eigen::Isometry3d& pose, double max_depth)
{
  RenderedLabels result{cv::Mat::zeros(camera.height, camera.width, CV_8UC1),
                        cv::Mat::zeros(camera.height, camera.width, CV_32FC1),
                        cv::Mat(camera.height, camera.width, CV_32SC1, cv::Scalar(-1))};
  const double size = voxels.voxel_size;
  const std::set<VoxelIndex, VoxelIndexLess> set(voxels.indices.begin(),
                                                 voxels.indices.end());
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d origin = pose.translation();
      const Eigen::Vector3d ray = pose.linear() * camera.unproject(u, v, 1.0);
      double nearest = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < voxels.size(); ++i) {
        const Eigen::Vector3d lower = voxels.indices[i].cast<double>() * size;
        bool too_near = false;
        for (int corner = 0; corner < 8; ++corner) {
          const Eigen::Vector3d offset(corner & 1, corner >> 1 & 1, corner >> 2);
          too_near = too_near || (pose.inverse() * (lower + size * offset)).z() < 0.1;
        }
        if (too_near)
          continue;
        Eigen::Vector3d begin = lower, end = lower.array() + size;
        for (int axis = 0; axis < 3; ++axis) {
          const VoxelIndex step = VoxelIndex::Unit(axis);
          const double surface = double((*voxels.cloud)[i].data[axis]);
          if (!set.count(voxels.indices[i] - step))
            begin[axis] = std::max(begin[axis], surface - 0.2 * size);
          if (!set.count(voxels.indices[i] + step))
            end[axis] = std::min(end[axis], surface + 0.2 * size);
        }
        for (int axis = 0; axis < 3; ++axis)
          for (const double plane : {begin[axis], end[axis]}) {
            const double depth = (plane - origin[axis]) / ray[axis];
            const Eigen::Vector3d at = origin + depth * ray;
            const int b = (axis + 1) % 3, c = (axis + 2) % 3;
            if (depth > 0.0 && depth <= max_depth && depth < nearest &&
                at[b] >= begin[b] && at[b] < end[b] && at[c] >= begin[c] &&
                at[c] < end[c]) {
              nearest = depth;
              result.labels.at<Label>(v, u) =
                  static_cast<Label>(voxels.cloud->points[i].label);
              result.depth.at<float>(v, u) = static_cast<float>(depth);
              result.indices.at<std::int32_t>(v, u) = static_cast<std::int32_t>(i);
            }
          }
      }
    }
  return result;
}

void
expectEqual(const RenderedLabels& result, const RenderedLabels& expected)
{
  EXPECT_EQ(cv::countNonZero(result.labels != expected.labels), 0);
  EXPECT_LT(cv::norm(result.depth, expected.depth, cv::NORM_INF), 1e-5);
  EXPECT_EQ(cv::countNonZero(result.indices != expected.indices), 0);
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

TEST(RenderLabels, FreeFacesLieAroundTheSurfaceAndSharedOnesStay)
{
  StereoCamera camera = smallCamera();
  camera.cx = 32.0;
  camera.cy = 20.0;
  camera.fx = camera.fy = 40.0;
  const auto labelAt = [&](const std::vector<VoxelIndex>& voxels, int v, int u) {
    return int(renderLabels(makeVoxels(voxels, 1.0), camera, forwardPose(), 40.0)
                   .labels.at<Label>(v, u));
  };
  // A cube of 1 m from 4 m on, y 0..1 (left) and z 0..1 (up), that is seen as 0.3..0.7
  // from 4.3 m on: columns 26 to 29, rows 14 to 17.
  const std::vector<VoxelIndex> one = {{4, 0, 0}};
  for (const int u : {26, 29})
    EXPECT_EQ(labelAt(one, 15, u), 1) << u;
  for (const int u : {25, 30})
    EXPECT_EQ(labelAt(one, 15, u), 0) << u;
  for (const int v : {14, 17})
    EXPECT_EQ(labelAt(one, v, 28), 1) << v;
  for (const int v : {13, 18})
    EXPECT_EQ(labelAt(one, v, 28), 0) << v;
  EXPECT_EQ(renderLabels(makeVoxels(one, 1.0), camera, forwardPose(), 40.0)
                .depth.at<float>(15, 28),
            4.3f);
  // With another one to its left, y 0.3..1.7: columns 17 to 29, no gap between them.
  const std::vector<VoxelIndex> two = {{4, 0, 0}, {4, 1, 0}};
  EXPECT_EQ(labelAt(two, 15, 16), 0);
  for (int u = 17; u <= 22; ++u)
    EXPECT_EQ(labelAt(two, 15, u), 2) << u;
  for (int u = 23; u <= 29; ++u)
    EXPECT_EQ(labelAt(two, 15, u), 1) << u;
}

TEST(RenderLabels, DepthLimitsAndFarFromTheOrigin)
{
  Eigen::Isometry3d pose = forwardPose();
  const auto seen = [&](const VoxelIndex& voxel, double max_depth) {
    return cv::countNonZero(
        renderLabels(makeVoxels({voxel}, 0.1), smallCamera(), pose, max_depth).depth);
  };
  EXPECT_GT(seen({10, 0, 0}, 1.0301), 0); // its face lies at 1.03 m
  EXPECT_EQ(seen({10, 0, 0}, 1.0299), 0);
  EXPECT_GT(seen({1, 0, 0}, 40.0), 0);   // at 0.1 m
  EXPECT_EQ(seen({0, 0, 0}, 40.0), 0);   // around the camera
  EXPECT_EQ(seen({-10, 0, 0}, 40.0), 0); // behind it
  const int near = seen({30, 1, 2}, 40.0);
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
