// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <Eigen/Core>

#include <cstddef>
#include <utility>
#include <vector>

namespace pcl_semantic {

/** \brief The squares of a grid in a plane that have points. */
class PlaneRaster {
public:
  using Square = std::pair<int, int>; ///< row, column

  /** \param[in] normal of length 1
   * \param[in] origin a point of the plane [m]
   * \param[in] edge of a square [m] */
  PlaneRaster(const Eigen::Vector3d& normal, const Eigen::Vector3d& origin,
              double edge);

  void add(const Eigen::Vector3d& point);

  /** \brief The squares, sorted. */
  const std::vector<Square>& squares();

  /** \brief [m^2] */
  double
  area()
  {
    return double(squares().size()) * edge_ * edge_;
  }

  /** \brief The point of the plane with these coordinates in squares. */
  Eigen::Vector3d
  position(double row, double column) const
  {
    return origin_ + edge_ * (column * u_ + row * v_);
  }

private:
  Eigen::Vector3d origin_, u_, v_; // u, v, normal: right-handed
  double edge_;
  std::vector<Square> squares_; // sorted when they are read
};

} // namespace pcl_semantic
