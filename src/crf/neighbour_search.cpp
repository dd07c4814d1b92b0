/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/neighbour_search.h>

#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace pcl_semantic {

namespace {

// Points sorted into cubic cells of half the radius, x fastest: the cells of a row that
// a search touches are one run of the sorted points.
class CellGrid {
public:
  static constexpr int kReach = 2; // cells a search looks into, to each side

  CellGrid(const Eigen::Matrix3Xf& positions, float radius)
      : cell_(radius / kReach), low_(positions.rowwise().minCoeff())
  {
    const Eigen::Array3d extent =
        (positions.rowwise().maxCoeff() - low_).cast<double>().array() / double(cell_);
    if ((extent >= double(1 << 20)).any())
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "positions lie " << extent.maxCoeff() / kReach
                                           << " radii apart, expected at most 500000");
    const auto count = static_cast<std::size_t>(positions.cols());
    keys_.resize(count);
    order_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      keys_[i] = key(cellOf(positions.col(Eigen::Index(i))));
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), [this](std::int32_t a, std::int32_t b) {
      return keys_[a] != keys_[b] ? keys_[a] < keys_[b] : a < b;
    });
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t row = keys_[order_[i]] >> kAxisBits;
      rows_.try_emplace(row, Row{i, i}).first->second.end = i + 1;
    }
  }

  Eigen::Array3i
  cellOf(const Eigen::Vector3f& position) const
  {
    return ((position - low_) / cell_).array().cast<int>() + kReach;
  }

  // Calls visit(j) for every point in the cells around one.
  template <typename Visit>
  void
  forEachNear(const Eigen::Array3i& cell, Visit&& visit) const
  {
    for (int dz = -kReach; dz <= kReach; ++dz)
      for (int dy = -kReach; dy <= kReach; ++dy) {
        const std::uint64_t first = key(cell + Eigen::Array3i(-kReach, dy, dz));
        const auto row = rows_.find(first >> kAxisBits);
        if (row == rows_.end())
          continue;
        auto at = std::lower_bound(
            order_.begin() + long(row->second.begin),
            order_.begin() + long(row->second.end), first,
            [this](std::int32_t i, std::uint64_t value) { return keys_[i] < value; });
        const std::uint64_t last = first + 2 * kReach;
        for (; at != order_.begin() + long(row->second.end) && keys_[*at] <= last; ++at)
          visit(*at);
      }
  }

private:
  static constexpr int kAxisBits = 21;

  struct Row {
    std::size_t begin;
    std::size_t end;
  };

  static std::uint64_t
  key(const Eigen::Array3i& cell)
  {
    return (std::uint64_t(cell.z()) << kAxisBits | std::uint64_t(cell.y()))
               << kAxisBits |
           std::uint64_t(cell.x());
  }

  float cell_;
  Eigen::Vector3f low_;
  std::vector<std::uint64_t> keys_; // by point
  std::vector<std::int32_t> order_; // points by key
  std::unordered_map<std::uint64_t, Row> rows_;
};

} // namespace

NeighbourLists
findNeighbours(const Eigen::Matrix3Xf& positions, float radius)
{
  NeighbourLists lists;
  const Eigen::Index count = positions.cols();
  lists.starts.assign(static_cast<std::size_t>(count) + 1, 0);
  if (count == 0)
    return lists;
  // On a grid many pairs lie at the radius exactly: rounding must not decide on them.
  const float reach = radius * 1.0001f;
  const CellGrid grid(positions, reach);
  const float limit = reach * reach;
  const auto search = [&](Eigen::Index i, auto&& found) {
    const Eigen::Vector3f centre = positions.col(i);
    grid.forEachNear(grid.cellOf(centre), [&](std::int32_t j) {
      if (j != i && (positions.col(j) - centre).squaredNorm() <= limit)
        found(j);
    });
  };

  // Counting first costs a second search, and saves a copy of all lists.
#pragma omp parallel for schedule(dynamic, 1024)
  for (Eigen::Index i = 0; i < count; ++i) {
    std::size_t found = 0;
    search(i, [&](std::int32_t) { ++found; });
    lists.starts[std::size_t(i) + 1] = found;
  }
  std::partial_sum(lists.starts.begin(), lists.starts.end(), lists.starts.begin());
  if (lists.starts.back() >= std::size_t(1) << 31)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        lists.starts.back()
                            << " pairs of points lie within " << radius
                            << " of each other: take a smaller radius or fewer points");
  lists.neighbours.resize(lists.starts.back());
#pragma omp parallel for schedule(dynamic, 1024)
  for (Eigen::Index i = 0; i < count; ++i) {
    std::int32_t* next = lists.neighbours.data() + lists.starts[std::size_t(i)];
    search(i, [&](std::int32_t j) { *next++ = j; });
  }
  return lists;
}

} // namespace pcl_semantic
