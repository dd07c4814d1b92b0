// SPDX-License-Identifier: BSD-3-Clause
#include "support/stereo_rigs.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/visible_points.h>
#include <pcl_semantic/evaluation/map_geometry.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace pcl_semantic {

namespace {

using Scan = pcl::PointCloud<pcl::PointXYZI>;

// A camera that looks along the world's x axis, moved and a little turned.
Eigen::Isometry3d
poseOf(int frame)
{
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::AngleAxisd(0.03 * frame, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      axes;
  pose.translation() << 1000.0 + frame, -0.4, 1.6;
  return pose;
}

Eigen::Isometry3d
scannerPose()
{
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.06, -0.08, -0.3;
  return pose;
}

struct Return {
  std::size_t frame;
  Eigen::Vector3d in_camera, in_world;
};

// Scans and a map of the same random points, some of them moved; more of the map
// elsewhere.
struct World {
  std::vector<Scan> scans;
  std::vector<Return> returns; // of all scans, one after the other
  VoxelCloud voxels;

  explicit World(int frames)
  {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> u(-20, 100), v(-10, 60), z(1.0, 45.0);
    std::normal_distribution<double> noise(0.0, 0.3);
    voxels.voxel_size = 0.2;
    for (int frame = 0; frame < frames; ++frame) {
      Scan scan;
      for (int i = 0; i < 700; ++i) {
        const Eigen::Vector3d seen =
            smallCamera().unproject(u(random), v(random), z(random));
        pcl::PointXYZI point;
        point.getVector3fMap() = (scannerPose().inverse() * seen).cast<float>();
        scan.push_back(point);
        const Eigen::Vector3d in_camera =
            scannerPose() * point.getVector3fMap().cast<double>();
        returns.push_back({std::size_t(frame), in_camera, poseOf(frame) * in_camera});
        const Eigen::Vector3d moved =
            poseOf(frame) * seen +
            Eigen::Vector3d(noise(random), noise(random), noise(random));
        if (i % 2)
          addVoxel(moved);
      }
      scans.push_back(scan);
    }
  }

  void
  addVoxel(const Eigen::Vector3d& position)
  {
    voxels.indices.push_back(
        (position / voxels.voxel_size).array().floor().cast<int>());
    pcl::PointXYZRGBL point;
    point.getVector3fMap() = position.cast<float>();
    voxels.cloud->push_back(point);
  }

  Eigen::Vector3d
  position(std::size_t i) const
  {
    return (*voxels.cloud)[i].getVector3fMap().cast<double>();
  }
};

// The rule of the header spelt out over all returns.
bool
isJudged(const World& world, std::size_t voxel, const GeometryParameters& parameters)
{
  const StereoCamera camera = smallCamera();
  const auto pixelIn = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector2d(std::floor(camera.fx * p.x() / p.z() + camera.cx + 0.5),
                           std::floor(camera.fy * p.y() / p.z() + camera.cy + 0.5));
  };
  const auto isInside = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector2d pixel = pixelIn(p);
    return p.z() > 0.1 && pixel.x() >= 0 && pixel.y() >= 0 &&
           pixel.x() < camera.width && pixel.y() < camera.height;
  };
  for (std::size_t frame = 0; frame < world.scans.size(); ++frame) {
    const Eigen::Vector3d p = poseOf(int(frame)).inverse() * world.position(voxel);
    if (!isInside(p) || p.z() > parameters.bands.back())
      continue;
    bool above = false, below = false;
    double farthest = 0.0;
    for (const Return& each : world.returns) {
      const Eigen::Vector3d& q = each.in_camera;
      if (each.frame != frame || !isInside(q))
        continue;
      const Eigen::Vector2d offset = pixelIn(q) - pixelIn(p);
      if (std::abs(offset.x()) > parameters.window_columns ||
          std::abs(offset.y()) > parameters.window_rows)
        continue;
      above = above || offset.y() <= 0;
      below = below || offset.y() >= 0;
      farthest = std::max(farthest, q.z());
    }
    if (above && below && p.z() <= farthest + parameters.behind)
      return true;
  }
  return false;
}

double
nearestReturn(const World& world, std::size_t voxel)
{
  double distance = 1e9;
  for (const Return& each : world.returns)
    distance = std::min(distance, (each.in_world - world.position(voxel)).norm());
  return distance;
}

bool
isNear(const World& world, const Eigen::Vector3d& point, double distance)
{
  const double size = world.voxels.voxel_size;
  return std::any_of(world.voxels.indices.begin(), world.voxels.indices.end(),
                     [&](const VoxelIndex& index) {
                       const Eigen::Vector3d lower = index.cast<double>() * size;
                       const Eigen::Vector3d upper = lower.array() + size;
                       return (point - point.cwiseMax(lower).cwiseMin(upper)).norm() <=
                              distance;
                     });
}

bool
hasVoxel(const World& world, const Eigen::Vector3d& point, int around)
{
  const VoxelIndex at = (point / world.voxels.voxel_size).array().floor().cast<int>();
  return std::any_of(world.voxels.indices.begin(), world.voxels.indices.end(),
                     [&](const VoxelIndex& index) {
                       return (index - at).cwiseAbs().maxCoeff() <= around;
                     });
}

GeometrySamples
measure(const World& world, const GeometryParameters& parameters)
{
  MapGeometry geometry(world.voxels, parameters);
  for (std::size_t frame = 0; frame < world.scans.size(); ++frame)
    geometry.addScan(world.scans[frame], smallCamera(), poseOf(int(frame)),
                     scannerPose());
  return geometry.samples();
}

} // namespace

TEST(MapGeometry, DistancesAreThoseOfAllPairs)
{
  const World world(2);
  GeometryParameters parameters;
  parameters.window_columns = 2;
  const GeometrySamples samples = measure(world, parameters);
  std::vector<double> expected;
  for (std::size_t i = 0; i < world.voxels.size(); ++i)
    if (isJudged(world, i, parameters))
      expected.push_back(nearestReturn(world, i));
  ASSERT_EQ(samples.distances.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    ASSERT_NEAR(samples.distances[i], expected[i], 1e-4);
  EXPECT_EQ(samples.voxels, world.voxels.size());
  EXPECT_GT(expected.size(), 100u);
  EXPECT_LT(expected.size(), world.voxels.size() - 100);
}

TEST(MapGeometry, SurfaceIsCountedByBand)
{
  const World world(2);
  GeometryParameters parameters;
  const GeometrySamples samples = measure(world, parameters);
  std::vector<SurfaceCounts> expected(3);
  std::vector<float> seen; // of all scans
  for (const auto& scan : world.scans)
    for (const SeenPoint& point :
         seenPoints(pointsInCamera(scan, scannerPose()), smallCamera()))
      seen.push_back(point.depth);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i] == 0.0f)
      continue;
    SurfaceCounts& band = expected[seen[i] < 10.0f ? 0 : seen[i] < 20.0f ? 1 : 2];
    const Eigen::Vector3d& point = world.returns[i].in_world;
    ++band.points;
    band.at += hasVoxel(world, point, 0);
    band.adjacent += hasVoxel(world, point, 1);
    band.within += isNear(world, point, parameters.within);
  }
  ASSERT_EQ(samples.surface.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(samples.surface[i].points, expected[i].points);
    EXPECT_EQ(samples.surface[i].at, expected[i].at);
    EXPECT_EQ(samples.surface[i].adjacent, expected[i].adjacent);
    EXPECT_EQ(samples.surface[i].within, expected[i].within);
    EXPECT_GT(expected[i].within, expected[i].at);
  }
}

TEST(MapGeometry, ScoresOfSamples)
{
  GeometrySamples samples;
  samples.voxels = 7;
  samples.distances = {0.5f, 0.05f, 0.15f, 0.3f, 2.0f};
  const GeometryScores scores = scoreGeometry(samples);
  EXPECT_EQ(scores.voxels, 7u);
  EXPECT_EQ(scores.judged, 5u);
  EXPECT_NEAR(scores.mean, 0.6, 1e-6);
  EXPECT_NEAR(scores.median, 0.3, 1e-6);
  EXPECT_NEAR(scores.percentile_90, 2.0, 1e-6);
  EXPECT_NEAR(scores.fractions[0], 0.2, 1e-9);
  EXPECT_NEAR(scores.fractions[1], 0.4, 1e-9);
  EXPECT_NEAR(scores.fractions[2], 0.8, 1e-9);
  EXPECT_TRUE(std::isnan(scoreGeometry({}).mean));

  GeometrySamples both = samples;
  both.surface = {{1, 1, 1, 1}};
  samples.surface = {{4, 1, 2, 3}, {5, 0, 0, 1}};
  both += samples;
  EXPECT_EQ(both.voxels, 14u);
  EXPECT_EQ(both.distances.size(), 10u);
  ASSERT_EQ(both.surface.size(), 2u);
  EXPECT_EQ(both.surface[0].points, 5u);
  EXPECT_EQ(both.surface[0].adjacent, 3u);
  EXPECT_EQ(both.surface[1].within, 1u);
}

TEST(MapGeometry, RefusesBandsThatDoNotGrow)
{
  for (const std::vector<double>& bands :
       {std::vector<double>{}, {10}, {0, 20, 20}, {-1, 20}}) {
    GeometryParameters parameters;
    parameters.bands = bands;
    EXPECT_THROW(MapGeometry(VoxelCloud(), parameters), InvalidParameterException);
  }
}

} // namespace pcl_semantic
