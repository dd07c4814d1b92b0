// SPDX-License-Identifier: BSD-3-Clause
#include "support/plain_map.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/dataset/kitti_sequence.h>
#include <pcl_semantic/dataset/lidar_scan.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <gtest/gtest.h>
#include <pcl/common/io.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

namespace {

using namespace pcl_semantic;
using Cloud = pcl::PointCloud<pcl::PointXYZ>;

const LabelSet one_class({{"thing", {200, 0, 0}}});

/** \brief Boxes on a road that rises by 1 %, between two walls. */
struct Street {
  double sensor_height = 1.73; ///< [m]
  double elevation_step = 0.4; ///< of the rings [degrees]
  double azimuth_step = 1.0;   ///< along a ring [degrees]
  std::vector<Eigen::AlignedBox3d> boxes;
};

// Distance to the first hit of a ray from inside the street.
double
distanceAlong(const Street& street, const Eigen::Vector3d& from,
              const Eigen::Vector3d& direction)
{
  constexpr double slope = 0.01, wall = 8.0;
  double nearest = std::numeric_limits<double>::infinity();
  const auto meets = [&](double distance) {
    if (distance > 0.0)
      nearest = std::min(nearest, distance);
  };
  meets((slope * from.x() - from.z()) / (direction.z() - slope * direction.x()));
  meets((std::copysign(wall, direction.y()) - from.y()) / direction.y());
  for (const Eigen::AlignedBox3d& box : street.boxes) {
    const Eigen::Array3d a = (box.min() - from).array() / direction.array();
    const Eigen::Array3d b = (box.max() - from).array() / direction.array();
    const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
    if (enter < leave)
      meets(enter);
  }
  return nearest;
}

// One turn of a lidar with rings as KITTI's has them; 2 cm of noise.
Cloud
scanOf(const Street& street, const Eigen::Vector3d& sensor, unsigned seed)
{
  constexpr double degree = M_PI / 180.0, range = 60.0;
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.02);
  Cloud cloud;
  for (double elevation = -24.8; elevation < 2.0; elevation += street.elevation_step)
    for (double azimuth = 0.25; azimuth < 360.0; azimuth += street.azimuth_step) {
      const double flat = std::cos(elevation * degree);
      const Eigen::Vector3d direction(flat * std::cos(azimuth * degree),
                                      flat * std::sin(azimuth * degree),
                                      std::sin(elevation * degree));
      const double distance = distanceAlong(street, sensor, direction);
      if (distance < range) {
        const Eigen::Vector3f point =
            ((distance + noise(random)) * direction).cast<float>();
        cloud.push_back({point.x(), point.y(), point.z()});
      }
    }
  return cloud;
}

Eigen::Isometry3d
poseOf(const Street& street, double x)
{
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(x, 0.03, 0.01 * x + street.sensor_height);
  return pose;
}

double
occupiedFraction(const SemanticVoxelMap& map, const Cloud& cloud,
                 const Eigen::Isometry3d& pose)
{
  std::size_t occupied = 0, points = 0;
  for (const pcl::PointXYZ& point : cloud)
    if (point.getVector3fMap().cwiseAbs().maxCoeff() <= map.parameters().max_range) {
      ++points;
      occupied += map.occupancy(pose * point.getVector3fMap().cast<double>()) ==
                  Occupancy::occupied;
    }
  return double(occupied) / double(points);
}

// The fraction of the last scan's points in occupied voxels after a drive.
double
leftOfLastScan(Clearing clearing, const Street& street, double voxel_size, int scans)
{
  MapParameters parameters;
  parameters.voxel_size = voxel_size;
  parameters.fusion.clearing = clearing;
  SemanticVoxelMap map(one_class, parameters);
  Cloud cloud;
  for (int i = 0; i < scans; ++i) {
    cloud = scanOf(street, poseOf(street, 0.5 * i).translation(), unsigned(i));
    map.integrate(cloud, poseOf(street, 0.5 * i));
  }
  return occupiedFraction(map, cloud, poseOf(street, 0.5 * (scans - 1)));
}

TEST(FreeSpace, GrazingRaysLeaveTheRoadWhereItIs)
{
  for (const double voxel_size : {0.1, 0.2})
    for (const int scans : {10, 100})
      EXPECT_GE(leftOfLastScan(Clearing::careful, {}, voxel_size, scans), 0.98)
          << voxel_size << " " << scans;
  EXPECT_LT(leftOfLastScan(Clearing::full, {}, 0.1, 10), 0.9); // its purpose
}

TEST(FreeSpace, ALowSensorKeepsItsGroundToo)
{
  Street street;
  street.sensor_height = 0.4;
  EXPECT_GE(leftOfLastScan(Clearing::careful, street, 0.05, 10), 0.98);
}

// Voxels of the car above the two layers over the road that are never cleared.
std::size_t
countOccupied(const SemanticVoxelMap& map, Eigen::AlignedBox3d box)
{
  box.min().z() += 0.3;
  std::size_t count = 0;
  for (const VoxelState& state : map.states(box))
    count += state.occupancy == Occupancy::occupied;
  return count;
}

// Voxels of a car that remain after ten scans with the car and ten without it.
std::size_t
leftOfCar(Clearing clearing)
{
  Street street;
  street.azimuth_step = 0.25;
  const Eigen::AlignedBox3d car(Eigen::Vector3d(14.0, 1.5, 0.14),
                                Eigen::Vector3d(18.2, 3.3, 1.6));
  street.boxes = {car};
  MapParameters parameters;
  parameters.fusion.clearing = clearing;
  SemanticVoxelMap map(one_class, parameters);
  for (int i = 0; i < 20; ++i) {
    if (i == 10) {
      EXPECT_GT(countOccupied(map, car), 300u);
      street.boxes.clear();
    }
    const Eigen::Isometry3d pose = poseOf(street, 0.3 * i);
    map.integrate(scanOf(street, pose.translation(), unsigned(i)), pose);
  }
  return countOccupied(map, car);
}

TEST(FreeSpace, ACarThatDrivesAwayIsErasedWithinTenScans)
{
  EXPECT_EQ(leftOfCar(Clearing::careful), 0u);
  EXPECT_EQ(leftOfCar(Clearing::full), 0u);
  EXPECT_GT(leftOfCar(Clearing::none), 300u);
}

TEST(FreeSpace, EqualsAPlainMapOnAStreet)
{
  Street street;
  street.elevation_step = 2.0;
  street.boxes = {{Eigen::Vector3d(3.0, 1.0, 0.0), Eigen::Vector3d(5.0, 3.0, 1.5)}};
  MapParameters parameters;
  parameters.voxel_size = 0.2;
  parameters.max_range = 9.0;
  SemanticVoxelMap map(one_class, parameters);
  PlainMap plain(one_class, parameters);
  for (int i = 0; i < 3; ++i) {
    LabelledScan scan;
    const Eigen::Isometry3d pose = poseOf(street, 0.3 * i);
    pcl::copyPointCloud(scanOf(street, pose.translation(), unsigned(i)), scan.cloud);
    scan.distributions = LabelDistributions(1, Eigen::Index(scan.cloud.size()));
    map.integrate(scan.cloud, pose, scan.distributions);
    plain.integrate(scan, pose);
  }
  expectSameOccupancy(map, plain);
}

TEST(FreeSpace, NoneClearsNothing)
{
  MapParameters parameters;
  parameters.fusion.clearing = Clearing::none;
  SemanticVoxelMap map(one_class, parameters);
  Cloud near, far;
  near.push_back({2.05f, 0.05f, 0.05f});
  far.push_back({8.25f, 0.25f, 0.25f});
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  map.integrate(near, pose);
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(map.integrate(far, pose).rays, 1u);
  EXPECT_EQ(map.occupancy({2.05, 0.05, 0.05}), Occupancy::occupied);
  EXPECT_EQ(map.occupancy({8.25, 0.25, 0.25}), Occupancy::occupied);
  EXPECT_EQ(map.occupancy({5.0, 0.15, 0.15}), Occupancy::unknown);
  EXPECT_EQ(map.occupied().size(), 2u);
  parameters.fusion.per_ray_counting = true;
  EXPECT_THROW(SemanticVoxelMap(one_class, parameters), InvalidParameterException);
}

TEST(FreeSpace, RealScansKeepTheirOwnPoints)
{
  const char* const data = std::getenv("PCL_SEMANTIC_DATA");
  if (!data)
    GTEST_SKIP() << "set PCL_SEMANTIC_DATA to the folder of real data";
  const std::string folder = std::string(data) + "/kitti/05";
  const KittiSequence sequence(folder);
  const Trajectory trajectory = readKittiTrajectory(sequence.posesPath());
  Eigen::Isometry3d T_world_camera_world = Eigen::Isometry3d::Identity();
  T_world_camera_world.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0; // z up
  SemanticVoxelMap map(one_class, MapParameters());
  Cloud cloud;
  Eigen::Isometry3d pose;
  for (int i = 0; i < 10; ++i) {
    const auto scan =
        readVelodyneScan(folder + "/velodyne/00000" + std::to_string(i) + ".bin");
    pcl::copyPointCloud(*scan, cloud);
    pose = T_world_camera_world * trajectory[std::size_t(i)] *
           sequence.T_camera0_velodyne();
    map.integrate(cloud, pose);
  }
  EXPECT_GE(occupiedFraction(map, cloud, pose), 0.98);
}

} // namespace
