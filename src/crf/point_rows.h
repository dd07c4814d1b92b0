// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Points sorted into cubic cells, and cells into rows along x, so that the
 * neighbours of a point are a few short runs of the sorted points.
 *
 * Rows are in the order z, y, x. For points on a grid, each in its own cell, the runs
 * contain only neighbours. */
class PointRows {
public:
  /** \brief See kernels/truncated_loops.h. */
  using Run = std::uint32_t;

  /** \param[in] positions 3 x N, finite
   * \param[in] reach distance up to which points are neighbours, more than 0
   * \param[in] cell edge of a cell, more than 0
   * \throws InvalidParameterException if there are too many points or their extent is
   * too large for the reach */
  PointRows(const Eigen::Matrix3Xf& positions, float reach, float cell);

  /** \brief Whether the number of points and their extent are within the limits. */
  static bool canHold(const Eigen::Matrix3Xf& positions, float cell);

  /** \brief Computes only order(). */
  static std::vector<std::int32_t> orderOf(const Eigen::Matrix3Xf& positions,
                                           float reach, float cell);

  std::size_t
  size() const
  {
    return order_.size();
  }

  /** \brief Original indices of the sorted points. */
  const std::vector<std::int32_t>&
  order() const
  {
    return order_;
  }

  /** \brief Up to kGroup neighbouring points of a row share their runs. */
  static constexpr std::size_t kGroup = 4;
  struct Groups {
    std::vector<std::uint32_t> point_ends; ///< of the groups: one past the last point
    std::vector<std::uint32_t> run_ends;   ///< of the groups
    std::vector<Run> runs;
  };

  /** \brief Groups of the sorted points of a range and the runs with all their
   * neighbours (including themselves, and possibly points beyond the reach). */
  Groups findRuns(std::size_t begin, std::size_t end) const;

private:
  PointRows(float reach, float cell);

  // Points with the same y and z, whose cells have no wide gap between them.
  struct Row {
    std::int32_t z, y;
    std::int32_t first_cell; // in x
    std::int32_t cells;
    std::uint32_t starts; // index in starts_: points before each cell, and before the
                          // end
  };
  class NearRows;

  void sort(const Eigen::Matrix3Xf& positions);
  void sortPoints(const Eigen::Matrix3Xf& positions, const Eigen::Array3f& high);
  void sortWithinCells(const Eigen::Matrix3Xf& positions);
  void buildRows(const Eigen::Matrix3Xf& positions);
  void findWidths(const Eigen::Array3f& slack);

  Eigen::Array3f low_;
  float cell_;
  float reach_;       // [cells]
  int row_reach_ = 0; // rows to search on each side
  /// Cells to search in x, by distance in z and y; -1 = none.
  std::vector<int> widths_;
  std::vector<std::int32_t> order_;
  std::vector<Eigen::Vector3i> cells_; // of the sorted points
  std::vector<std::uint32_t> row_of_;  // of the sorted points
  std::vector<std::uint32_t> starts_;
  std::vector<Row> rows_;
};

} // namespace pcl_semantic
