// SPDX-License-Identifier: BSD-3-Clause

// The search of PointRows: which rows lie near one, and which runs of them.

#include "kernels/run_search.h"
#include "point_rows.h"

#include <algorithm>

namespace pcl_semantic {

// The rows near a row.
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
    for (int k = 0; k < 16; ++k) // loops go by as many rows at a time
      append(Row{}, 0);
    return {points_.starts_.data(), arrays_[0].data(), arrays_[1].data(),
            arrays_[2].data(),      arrays_[3].data(), count_ - 16};
  }

private:
  // The first row that may be near, of those with some z.
  struct First {
    std::int32_t z;
    std::size_t row;
  };

  std::size_t
  findFirst(First& first, std::int32_t z, std::int32_t y) const
  {
    const std::vector<Row>& all = points_.rows_;
    const auto before = [&](const Row& r) { return r.z < z || (r.z == z && r.y < y); };
    if (first.z != z) // else rows come in order: the one sought cannot be far
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

// As the searches of kernels/, for runs of any length.
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
  constexpr int widest_group = 4; // wider, too many pairs would lie beyond the reach
  const kernels::RunSearch findShortRuns = kernels::runSearch(simdTier());
  NearRows search(*this);
  kernels::NearRowsView near{};
  Groups groups;
  groups.runs.reserve(16 * (end - begin)); // of surfaces
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
        findShortRuns(near, cell, cells_[last - 1].x(), found.data());
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
