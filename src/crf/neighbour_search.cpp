/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/crf/neighbour_search.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <unordered_map>

namespace pcl_semantic {

namespace {

// More than that is no neighbourhood; checked while searching, before memory is full.
constexpr std::size_t largest_pairs = std::size_t(1) << 31;

// A run of points in the order of their cells.
struct Run {
  std::size_t begin;
  std::size_t end;
};

// Points sorted into cubic cells of half the radius, x fastest: the cells of a row that
// a search touches are one run of the sorted points, the same for all points of a cell.
class CellGrid {
public:
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
    std::vector<std::uint64_t> keys(count);
    for (std::size_t i = 0; i < count; ++i)
      keys[i] = key(positions.col(Eigen::Index(i)));
    std::iota(order_.begin(), order_.end(), 0);
    std::sort(order_.begin(), order_.end(), [&](std::int32_t a, std::int32_t b) {
      return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
    });
    positions_.resize(3, positions.cols());
    for (std::size_t i = 0; i < count; ++i) {
      keys_[i] = keys[order_[i]];
      positions_.col(Eigen::Index(i)) = positions.col(order_[i]);
      rows_.try_emplace(keys_[i] >> kAxisBits, Run{i, i}).first->second.end = i + 1;
      if (i == 0 || keys_[i] != keys_[i - 1])
        cells_.push_back({i, i});
      cells_.back().end = i + 1;
    }
  }

  // The cells that hold points, as runs of sorted points.
  const std::vector<Run>&
  cells() const
  {
    return cells_;
  }

  // Number of a sorted point in the caller's order.
  std::int32_t
  original(std::size_t sorted) const
  {
    return order_[sorted];
  }

  // The runs of points that may lie within the radius of the points of a cell.
  void
  findCandidates(const Run& cell, std::vector<Run>& candidates) const
  {
    candidates.clear();
    const std::int64_t centre = std::int64_t(keys_[cell.begin]);
    for (std::int64_t dz = -kReach; dz <= kReach; ++dz)
      for (std::int64_t dy = -kReach; dy <= kReach; ++dy) {
        const std::uint64_t first =
            std::uint64_t(centre + dz * (std::int64_t(1) << 2 * kAxisBits) +
                          dy * (1 << kAxisBits) - kReach);
        const auto row = rows_.find(first >> kAxisBits);
        if (row == rows_.end())
          continue;
        const auto begin = keys_.begin() + long(row->second.begin);
        const auto end = keys_.begin() + long(row->second.end);
        const auto low = std::lower_bound(begin, end, first);
        const auto high = std::upper_bound(low, end, first + 2 * kReach);
        if (low != high)
          candidates.push_back(
              {std::size_t(low - keys_.begin()), std::size_t(high - keys_.begin())});
      }
  }

  // Appends the points of the runs that lie within the radius of a sorted point.
  void
  appendNear(std::size_t point, const std::vector<Run>& candidates,
             float squared_radius, std::vector<std::int32_t>& near) const
  {
    const Eigen::Vector3f centre = positions_.col(Eigen::Index(point));
    for (const Run& run : candidates) {
      std::size_t size = near.size();
      near.resize(size + run.end - run.begin);
      for (std::size_t j = run.begin; j < run.end; ++j) {
        near[size] = order_[j];
        size += (positions_.col(Eigen::Index(j)) - centre).squaredNorm() <=
                    squared_radius &&
                j != point;
      }
      near.resize(size);
    }
  }

private:
  static constexpr int kReach = 2; // cells a search looks into, to each side
  static constexpr int kAxisBits = 21;

  std::uint64_t
  key(const Eigen::Vector3f& position) const
  {
    const Eigen::Array3i cell =
        ((position - low_) / cell_).array().cast<int>() + kReach;
    return (std::uint64_t(cell.z()) << kAxisBits | std::uint64_t(cell.y()))
               << kAxisBits |
           std::uint64_t(cell.x());
  }

  float cell_;
  Eigen::Vector3f low_;
  std::vector<std::int32_t> order_; // points by cell
  std::vector<std::uint64_t> keys_; // their cells
  Eigen::Matrix3Xf positions_;      // their positions
  std::vector<Run> cells_;
  std::unordered_map<std::uint64_t, Run> rows_;
};

// The neighbours of the points of a few cells, point after point.
struct Chunk {
  std::vector<std::int32_t> neighbours;
  std::vector<std::size_t> ends; // by point, in the order of the cells
};

Chunk
searchCells(const CellGrid& grid, Run cells, float squared_radius)
{
  Chunk chunk;
  std::vector<Run> candidates;
  for (std::size_t c = cells.begin; c < cells.end; ++c) {
    const Run& cell = grid.cells()[c];
    grid.findCandidates(cell, candidates);
    for (std::size_t point = cell.begin; point < cell.end; ++point) {
      grid.appendNear(point, candidates, squared_radius, chunk.neighbours);
      chunk.ends.push_back(chunk.neighbours.size());
    }
  }
  return chunk;
}

// Copies the neighbours from the order of the cells into that of the points.
void
gather(const CellGrid& grid, const std::vector<Chunk>& chunks,
       std::size_t cells_a_chunk, NeighbourLists& lists)
{
  const auto forEachPoint = [&](std::size_t c, auto&& visit) {
    std::size_t point = grid.cells()[c * cells_a_chunk].begin, begin = 0;
    for (const std::size_t end : chunks[c].ends) {
      visit(std::size_t(grid.original(point++)), begin, end);
      begin = end;
    }
  };
  for (std::size_t c = 0; c < chunks.size(); ++c)
    forEachPoint(c, [&](std::size_t i, std::size_t begin, std::size_t end) {
      lists.starts[i + 1] = end - begin;
    });
  std::partial_sum(lists.starts.begin(), lists.starts.end(), lists.starts.begin());
  lists.neighbours.resize(lists.starts.back());
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t c = 0; c < chunks.size(); ++c)
    forEachPoint(c, [&](std::size_t i, std::size_t begin, std::size_t end) {
      std::copy(chunks[c].neighbours.begin() + long(begin),
                chunks[c].neighbours.begin() + long(end),
                lists.neighbours.begin() + long(lists.starts[i]));
    });
}

} // namespace

NeighbourLists
findNeighbours(const Eigen::Matrix3Xf& positions, float radius)
{
  NeighbourLists lists;
  lists.starts.assign(static_cast<std::size_t>(positions.cols()) + 1, 0);
  if (positions.cols() == 0)
    return lists;
  // On a grid many pairs lie at the radius exactly: rounding must not decide on them.
  const float reach = radius * 1.0001f;
  const CellGrid grid(positions, reach);
  constexpr std::size_t cells_a_chunk = 64;
  const std::size_t cells = grid.cells().size();
  std::vector<Chunk> chunks((cells + cells_a_chunk - 1) / cells_a_chunk);
  std::atomic<std::size_t> pairs{0};
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t c = 0; c < chunks.size(); ++c)
    guard.run([&] {
      if (pairs < largest_pairs) // else it is refused below
        chunks[c] = searchCells(
            grid, {c * cells_a_chunk, std::min(cells, (c + 1) * cells_a_chunk)},
            reach * reach);
      pairs += chunks[c].neighbours.size();
    });
  guard.rethrow();
  if (pairs >= largest_pairs)
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "more than "
                            << largest_pairs << " pairs of points lie within " << radius
                            << " of each other: take a smaller radius or fewer points");

  gather(grid, chunks, cells_a_chunk, lists);
  return lists;
}

} // namespace pcl_semantic
