// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Sums of points, from which their plane of least squares follows. */
class PlaneMoments {
public:
  /** \param[in] reference a position near the points [m]: sums of squares of large
   * coordinates would lose digits */
  explicit PlaneMoments(const Eigen::Vector3d& reference = Eigen::Vector3d::Zero())
      : reference_(reference)
  {}

  void
  add(const Eigen::Vector3d& point)
  {
    const Eigen::Vector3d p = point - reference_;
    ++count_;
    sum_ += p;
    squares_[0] += p.x() * p.x();
    squares_[1] += p.x() * p.y();
    squares_[2] += p.x() * p.z();
    squares_[3] += p.y() * p.y();
    squares_[4] += p.y() * p.z();
    squares_[5] += p.z() * p.z();
  }

  std::size_t
  count() const
  {
    return count_;
  }

  Eigen::Vector3d
  mean() const
  {
    return reference_ + sum_ / double(count_);
  }

  /** \brief Covariance: xx, xy, xz, yy, yz, zz [m^2]. */
  std::array<double, 6> covariance() const;

private:
  Eigen::Vector3d reference_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  std::array<double, 6> squares_{}; // xx, xy, xz, yy, yz, zz
  std::size_t count_ = 0;
};

/** \brief A plane of least squares. */
struct FittedPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< zero: the points have no plane
  Eigen::Vector3d centre = Eigen::Vector3d::Zero(); ///< mean of the points [m]
  double curvature = 1.0; ///< least eigenvalue of the covariance / sum, 0 to 1/3
  double deviation = 0.0; ///< root mean square of the distances of the points [m]
  /// Whether the points are a surface: not on a line, nor as thick as they are wide.
  bool is_surface = false;

  double
  distance(const Eigen::Vector3d& point) const
  {
    return std::abs(normal.dot(point - centre));
  }
};

/** \brief Fits a plane. It has no normal if the points are fewer than three or lie on
 * a line. Uses no function of the mathematical library but the square root, so all
 * platforms give the same bits. The largest component of the normal is positive. */
FittedPlane fitPlane(const PlaneMoments& moments);

/** \brief The points of one cube of a grid. */
struct SurfaceCell {
  std::size_t first = 0, last = 0; ///< its points, a range of SurfaceCells::order()
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(); ///< of its points [m]
  FittedPlane plane; ///< of the means within the radius; no normal unless they are a
                     ///< surface
};

/** \brief Points sorted into the cubes of a grid, with the plane of each cube's
 * surroundings. The means of the cubes count, so the density of the points does not
 * matter, and the time is linear in the number of points. */
class SurfaceCells {
public:
  /** \param[in] points finite positions [m]
   * \param[in] radius of the surroundings [m]; the edge of a cube is half of it
   * \throws BadInputException if the points have more than 2^21 cubes along an axis,
   * without the gaps between distant points */
  SurfaceCells(const std::vector<Eigen::Vector3d>& points, double radius);

  std::size_t
  size() const
  {
    return cells_.size();
  }

  /** \brief Cells in the order z, y, x. */
  const SurfaceCell&
  operator[](std::size_t cell) const
  {
    return cells_[cell];
  }

  /** \brief Third quartile of the deviations of cells with a normal [m]: the noise of
   * the points, if most surfaces are flat. 0 if there is no such cell. */
  double deviation() const;

  /** \brief Indices of the points by cell; in a cell by z, y, x. */
  const std::vector<std::size_t>&
  order() const
  {
    return order_;
  }

  /** \brief Calls \a visit with each other cell whose mean is within the radius. */
  template <typename Visit>
  void
  forEachNeighbour(std::size_t cell, Visit&& visit) const
  {
    for (std::size_t i = starts_[cell]; i < starts_[cell + 1]; ++i)
      visit(std::size_t(neighbours_[i]));
  }

private:
  using Key = std::uint64_t; // z, y, x of a cube

  void sort(const std::vector<Eigen::Vector3d>& points);
  void findNeighbours();
  void fitPlanes();

  double radius_;
  std::vector<std::size_t> order_;
  std::vector<Key> keys_; // of the cells
  std::vector<SurfaceCell> cells_;
  std::vector<std::size_t> starts_;      // of each cell in neighbours_
  std::vector<std::int32_t> neighbours_; // cells
};

} // namespace pcl_semantic
