// SPDX-License-Identifier: BSD-3-Clause
#include "point_rows.h"
#include "core/fail.h"
#include "kernels/truncated_loops.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace pcl_semantic {

namespace {

constexpr std::size_t max_points = std::size_t(1) << (32 - kernels::run_length_bits);
constexpr double max_cells = 1 << 20; // along an axis

// Stable radix sort of the numbers 0..N-1 by key.
std::vector<std::int32_t>
sortByKey(std::vector<std::uint64_t> keys, std::uint64_t largest)
{
  constexpr int digit_bits = 11;
  std::vector<std::int32_t> order(keys.size()), next_order(keys.size());
  std::iota(order.begin(), order.end(), 0);
  if (std::is_sorted(keys.begin(), keys.end()))
    return order;
  std::vector<std::uint64_t> next_keys(keys.size());
  for (int shift = 0; shift < 64 && largest >> shift; shift += digit_bits) {
    std::vector<std::size_t> starts((1 << digit_bits) + 1, 0);
    const auto digit = [&](std::uint64_t key) {
      return (key >> shift) & ((1 << digit_bits) - 1);
    };
    for (const std::uint64_t key : keys)
      ++starts[digit(key) + 1];
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const std::size_t position = starts[digit(keys[i])]++;
      next_keys[position] = keys[i];
      next_order[position] = order[i];
    }
    keys.swap(next_keys);
    order.swap(next_order);
  }
  return order;
}

// Bounding box of the points, at least one.
std::pair<Eigen::Array3f, Eigen::Array3f>
boundsOf(const Eigen::Matrix3Xf& positions)
{
  Eigen::Array3f low = positions.col(0), high = low;
  for (Eigen::Index i = 1; i < positions.cols(); ++i) {
    low = low.min(positions.col(i).array());
    high = high.max(positions.col(i).array());
  }
  return {low, high};
}

} // namespace

PointRows::PointRows(float reach, float cell)
    // On a grid many pairs lie exactly at the reach; the margin avoids rounding
    // decisions.
    : cell_(cell), reach_(reach / cell * 1.0001f)
{}

PointRows::PointRows(const Eigen::Matrix3Xf& positions, float reach, float cell)
    : PointRows(reach, cell)
{
  sort(positions);
  if (size() > 0)
    buildRows(positions);
}

std::vector<std::int32_t>
PointRows::orderOf(const Eigen::Matrix3Xf& positions, float reach, float cell)
{
  PointRows rows(reach, cell);
  rows.sort(positions);
  return std::move(rows.order_);
}

bool
PointRows::canHold(const Eigen::Matrix3Xf& positions, float cell)
{
  if (positions.cols() == 0)
    return true;
  const auto [low, high] = boundsOf(positions);
  return positions.cols() < Eigen::Index(max_points) &&
         double((high - low).maxCoeff()) / double(cell) < max_cells;
}

void
PointRows::sort(const Eigen::Matrix3Xf& positions)
{
  if (positions.cols() >= Eigen::Index(max_points))
    badParameter(positions.cols(), " points, expected less than ", max_points);
  if (positions.cols() == 0)
    return;
  Eigen::Array3f high;
  std::tie(low_, high) = boundsOf(positions);
  const Eigen::Array3d extent = (high - low_).cast<double>() / double(cell_);
  if (!(extent < max_cells).all())
    badParameter("positions lie ", extent.maxCoeff() * double(cell_),
                 " apart, expected at most ", max_cells * double(cell_),
                 " for truncated kernels: take lattices, or "
                 "leave out what lies far off");
  sortPoints(positions, high);
}

void
PointRows::sortPoints(const Eigen::Matrix3Xf& positions, const Eigen::Array3f& high)
{
  const auto count = static_cast<std::size_t>(positions.cols());
  // Shifted by half a cell, so that points of a grid lie in the middle of their cells.
  const auto cellOf = [&](const auto& position) -> Eigen::Vector3i {
    return ((position.array() - low_) / cell_ + 0.5f).template cast<int>().matrix();
  };
  std::vector<Eigen::Vector3i> cells(count);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < count; ++i)
    cells[i] = cellOf(positions.col(Eigen::Index(i)));
  const Eigen::Vector3i most = cellOf(high.matrix());
  const std::uint64_t nx = std::uint64_t(most.x()) + 1,
                      ny = std::uint64_t(most.y()) + 1;
  std::vector<std::uint64_t> keys(count);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < count; ++i)
    keys[i] = (std::uint64_t(cells[i].z()) * ny + std::uint64_t(cells[i].y())) * nx +
              std::uint64_t(cells[i].x());
  order_ = sortByKey(std::move(keys), (std::uint64_t(most.z()) + 1) * nx * ny);
  cells_.resize(count);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < count; ++i)
    cells_[i] = cells[std::size_t(order_[i])];
  sortWithinCells(positions);
}

// Sums must not depend on the input order of the points.
void
PointRows::sortWithinCells(const Eigen::Matrix3Xf& positions)
{
  const auto before = [&](std::int32_t a, std::int32_t b) {
    const float* const p = positions.col(a).data();
    const float* const q = positions.col(b).data();
    return std::lexicographical_compare(p, p + 3, q, q + 3);
  };
  for (std::size_t begin = 0, end = 0; begin < size(); begin = end) {
    for (end = begin + 1; end < size() && cells_[end] == cells_[begin];)
      ++end;
    if (end > begin + 1)
      std::stable_sort(order_.begin() + std::ptrdiff_t(begin),
                       order_.begin() + std::ptrdiff_t(end), before);
  }
}

void
PointRows::buildRows(const Eigen::Matrix3Xf& positions)
{
  constexpr int widest_gap = 256; // up to this width, a table is cheaper than another
                                  // row
  row_of_.resize(size());
  starts_.reserve(4 * size());
  // Positions within the cells; on a grid they are all the same.
  Eigen::Array3f lowest = Eigen::Array3f::Ones(), highest = -lowest;
  for (std::size_t i = 0; i < size(); ++i) {
    const Eigen::Vector3i& cell = cells_[i];
    const Eigen::Array3f position =
        (positions.col(order_[i]).array() - low_) / cell_ - cell.array().cast<float>();
    lowest = lowest.min(position);
    highest = highest.max(position);
    if (i == 0 || cell.z() != cells_[i - 1].z() || cell.y() != cells_[i - 1].y() ||
        cell.x() > cells_[i - 1].x() + widest_gap) {
      if (i > 0)
        starts_.push_back(std::uint32_t(i));
      rows_.push_back({cell.z(), cell.y(), cell.x(), 0, std::uint32_t(starts_.size())});
    }
    Row& row = rows_.back();
    for (; row.cells <= cell.x() - row.first_cell; ++row.cells)
      starts_.push_back(std::uint32_t(i));
    row_of_[i] = std::uint32_t(rows_.size() - 1);
  }
  starts_.push_back(std::uint32_t(size()));
  findWidths(highest - lowest);
}

// slack: difference between the distance of cells and of their points, at most [cells]
void
PointRows::findWidths(const Eigen::Array3f& slack)
{
  row_reach_ = int(reach_ + slack.tail<2>().maxCoeff());
  for (int z = -row_reach_; z <= row_reach_; ++z)
    for (int y = -row_reach_; y <= row_reach_; ++y) {
      const float dz = std::max(0.0f, float(std::abs(z)) - slack.z());
      const float dy = std::max(0.0f, float(std::abs(y)) - slack.y());
      const float squared = reach_ * reach_ - dy * dy - dz * dz;
      widths_.push_back(squared < 0.0f ? -1 : int(std::sqrt(squared) + slack.x()));
    }
}

class PointRows::NearRows {
public:
  explicit NearRows(const PointRows& points) : points_(points) {}

  kernels::NearRowsView
  find(const Row& row)
  {
    count_ = 0;
    const std::vector<Row>& all = points_.rows_;
    const int reach = points_.row_reach_;
    const int* widths = points_.widths_.data() + reach;
    firsts_.resize(std::size_t(2 * reach + 1), {-1, 0});
    for (First& first : firsts_) {
      const auto z = std::int32_t(row.z + (&first - firsts_.data()) - reach);
      std::size_t r = findFirst(first, z, row.y - reach);
      for (; r < all.size() && all[r].z == z && all[r].y <= row.y + reach; ++r) {
        const int width = widths[all[r].y - row.y];
        if (width >= 0 && all[r].first_cell - width < row.first_cell + row.cells &&
            row.first_cell - width < all[r].first_cell + all[r].cells)
          append(all[r], width);
      }
      widths += 2 * reach + 1;
    }
    for (int k = 0; k < 16; ++k) // loops process 16 rows at once
      append(Row{}, 0);
    return {points_.starts_.data(), arrays_[0].data(), arrays_[1].data(),
            arrays_[2].data(),      arrays_[3].data(), count_ - 16};
  }

private:
  // The first row, of those with the same z, that may be near.
  struct First {
    std::int32_t z;
    std::size_t row;
  };

  std::size_t
  findFirst(First& first, std::int32_t z, std::int32_t y) const
  {
    const std::vector<Row>& all = points_.rows_;
    const auto before = [&](const Row& r) { return r.z < z || (r.z == z && r.y < y); };
    if (first.z != z) // otherwise rows are in order, and the next one is close
      first = {z, std::size_t(std::partition_point(all.begin(), all.end(), before) -
                              all.begin())};
    while (first.row < all.size() && before(all[first.row]))
      ++first.row;
    return first.row;
  }

  void
  append(const Row& row, int width)
  {
    if (count_ == arrays_[0].size())
      for (std::vector<std::int32_t>& array : arrays_)
        array.resize(2 * count_ + 128);
    arrays_[0][count_] = std::int32_t(row.starts);
    arrays_[1][count_] = row.first_cell;
    arrays_[2][count_] = row.cells;
    arrays_[3][count_++] = width;
  }

  const PointRows& points_;
  std::vector<First> firsts_;           // by z
  std::vector<std::int32_t> arrays_[4]; // of the rows found, see NearRowsView
  std::size_t count_ = 0;
};

namespace {

// As TruncatedLoops::findRuns, for runs of any length.
void
appendLongRuns(const kernels::NearRowsView& rows, std::int32_t first, std::int32_t last,
               std::vector<PointRows::Run>& runs)
{
  for (std::size_t r = 0; r < rows.count; ++r) {
    const auto startOf = [&](std::int32_t cell) {
      return rows.starts[rows.first_starts[r] +
                         std::clamp(cell - rows.first_cells[r], 0, rows.cells[r])];
    };
    const std::uint32_t end = startOf(last + rows.widths[r] + 1);
    for (std::uint32_t point = startOf(first - rows.widths[r]); point < end;) {
      const std::uint32_t length = std::min(end - point, kernels::longest_run);
      runs.push_back(point << kernels::run_length_bits | length);
      point += length;
    }
  }
}

} // namespace

PointRows::Groups
PointRows::findRuns(std::size_t begin, std::size_t end) const
{
  constexpr int widest_group = 4; // wider groups would contain too many pairs beyond
                                  // the reach
  const kernels::TruncatedLoops& loops = kernels::truncatedLoops();
  NearRows search(*this);
  kernels::NearRowsView near{};
  Groups groups;
  groups.runs.reserve(16 * (end - begin)); // estimate for surfaces
  std::vector<Run> found;
  for (std::size_t i = begin, last = i; i < end; i = last) {
    const std::int32_t cell = cells_[i].x();
    for (last = i + 1; last < end && last < i + kGroup && row_of_[last] == row_of_[i] &&
                       cells_[last].x() < cell + widest_group;)
      ++last;
    if (i == begin || row_of_[i] != row_of_[i - 1])
      near = search.find(rows_[row_of_[i]]);
    found.resize(near.count + 16);
    const std::size_t count =
        loops.findRuns(near, cell, cells_[last - 1].x(), found.data());
    if (count == kernels::run_too_long)
      appendLongRuns(near, cell, cells_[last - 1].x(), groups.runs);
    else
      groups.runs.insert(groups.runs.end(), found.begin(), found.begin() + long(count));
    groups.run_ends.push_back(std::uint32_t(groups.runs.size()));
    groups.point_ends.push_back(std::uint32_t(last));
  }
  return groups;
}

} // namespace pcl_semantic
