// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace pcl_semantic {

/** \brief What a point of TiltedStreet lies on. */
enum class Surface { none, ground, kerb, wall };

/** \brief A road, a pavement on its right and a wall behind that, to 40 m, seen by a
 * camera that is turned. */
struct TiltedStreet {
  static constexpr int width = 240;
  static constexpr int height = 120;
  static constexpr double camera_height = 1.65;
  static constexpr double kerb_height = 0.12;

  explicit TiltedStreet(const Eigen::Matrix3d& turn);

  pcl::PointCloud<pcl::PointXYZRGB> cloud{width, height};
  std::vector<Surface> surfaces;
  std::vector<double> heights;         // above the road
  Eigen::Hyperplane<double, 3> ground; // the truth
  std::vector<std::uint8_t> is_ground; // road and pavement
};

inline TiltedStreet::TiltedStreet(const Eigen::Matrix3d& turn)
    : ground(turn * Eigen::Vector3d(0, -1, 0), camera_height)
{
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const Eigen::Vector3d ray((u - 120.0) / 150.0, (v - 45.0) / 150.0, 1.0);
      const Eigen::Vector3d level_ray = turn.transpose() * ray; // x right, y down
      Surface surface = Surface::none;
      double nearest = 40.0;
      const auto meet = [&](Surface what, double depth) {
        const double x = depth * level_ray.x();
        if (depth <= 0.0 || depth >= nearest || (what == Surface::ground && x > 3.0) ||
            (what == Surface::kerb && x < 3.0))
          return;
        nearest = depth;
        surface = what;
      };
      meet(Surface::ground, camera_height / level_ray.y());
      meet(Surface::kerb, (camera_height - kerb_height) / level_ray.y());
      meet(Surface::wall, 5.0 / level_ray.x());
      pcl::PointXYZRGB& point = cloud(std::size_t(u), std::size_t(v));
      point.getVector3fMap().setConstant(std::numeric_limits<float>::quiet_NaN());
      if (surface != Surface::none)
        point.getVector3fMap() = (nearest * ray).cast<float>();
      surfaces.push_back(surface);
      heights.push_back(camera_height - nearest * level_ray.y());
      is_ground.push_back(surface == Surface::ground || surface == Surface::kerb);
    }
}

/** \brief Pitch, and half as much roll [degrees]. */
inline Eigen::Matrix3d
turned(double degrees)
{
  const double angle = degrees * M_PI / 180.0;
  return (Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()) *
          Eigen::AngleAxisd(0.5 * angle, Eigen::Vector3d::UnitZ()))
      .toRotationMatrix();
}

} // namespace pcl_semantic
