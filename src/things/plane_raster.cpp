// SPDX-License-Identifier: BSD-3-Clause
#include "plane_raster.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

PlaneRaster::PlaneRaster(const Eigen::Vector3d& normal, const Eigen::Vector3d& origin,
                         double edge)
    : origin_(origin), edge_(edge)
{
  Eigen::Index least;
  normal.cwiseAbs().minCoeff(&least);
  u_ = normal.cross(Eigen::Vector3d::Unit(least));
  u_ /= std::sqrt(u_.squaredNorm());
  v_ = normal.cross(u_);
}

void
PlaneRaster::add(const Eigen::Vector3d& point)
{
  const Eigen::Vector3d p = (point - origin_) / edge_;
  squares_.emplace_back(int(std::floor(v_.dot(p))), int(std::floor(u_.dot(p))));
}

const std::vector<PlaneRaster::Square>&
PlaneRaster::squares()
{
  std::sort(squares_.begin(), squares_.end());
  squares_.erase(std::unique(squares_.begin(), squares_.end()), squares_.end());
  return squares_;
}

} // namespace pcl_semantic
