// SPDX-License-Identifier: BSD-3-Clause
#include "element_tiles.h"

#include "core/parallel_guard.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace pcl_semantic {

namespace {

using Box = Eigen::AlignedBox<float, Eigen::Dynamic>;

Box
boundsOf(const Eigen::MatrixXf& positions, const pcl::Indices& elements)
{
  Box box(positions.rows());
  for (const pcl::index_t i : elements)
    box.extend(positions.col(i));
  return box;
}

std::size_t
sizeOf(const ElementTile& tile)
{
  return tile.own.size() + tile.halo.size();
}

std::vector<float>
coordinatesOf(const Eigen::MatrixXf& positions, const pcl::Indices& elements,
              Eigen::Index axis)
{
  std::vector<float> values;
  values.reserve(elements.size());
  for (const pcl::index_t i : elements)
    values.push_back(positions(axis, i));
  return values;
}

// The value with a number of smaller ones, or the least value above the lowest one.
float
middleOf(const Eigen::MatrixXf& positions, const pcl::Indices& elements,
         Eigen::Index axis, float low, std::size_t smaller)
{
  std::vector<float> values = coordinatesOf(positions, elements, axis);
  const auto middle = values.begin() + std::ptrdiff_t(smaller);
  std::nth_element(values.begin(), middle, values.end());
  if (*middle > low)
    return *middle;
  float least = HUGE_VALF;
  for (const float value : values)
    if (value > low)
      least = std::min(least, value);
  return least;
}

// The value after the gap that is nearest to the median, of those wider than a
// distance. The largest gap could leave a single element on a side, again and again.
std::optional<float>
afterGap(const Eigen::MatrixXf& positions, const pcl::Indices& elements,
         Eigen::Index axis, float distance)
{
  std::vector<float> values = coordinatesOf(positions, elements, axis);
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  for (std::size_t k = 0; k < values.size(); ++k)
    for (const std::size_t i : {middle - k, middle + 1 + k}) // i may wrap below 0
      if (i > 0 && i < values.size() && values[i] - values[i - 1] > distance)
        return values[i];
  return std::nullopt;
}

} // namespace

TileBoxes::TileBoxes(const Eigen::MatrixXf& positions, const TileLimits& limits,
                     const Visit& visit)
    : limits_(limits), reach_(float(limits.reach))
{
  ElementTile all;
  all.own.resize(std::size_t(positions.cols()));
  std::iota(all.own.begin(), all.own.end(), 0);
  divide(positions, std::move(all), visit);
}

std::size_t
TileBoxes::boxOf(const Eigen::Vector3f& position) const
{
  const Node* node = nodes_.data();
  while (node->left >= 0)
    node = &nodes_[std::size_t(position[node->axis] < node->middle ? node->left
                                                                   : node->right)];
  return node->box;
}

int
TileBoxes::addBox(const ElementTile& tile, const Visit& visit)
{
  nodes_.back().box = boxes_++;
  if (visit && !tile.own.empty())
    visit(tile);
  return int(nodes_.size()) - 1;
}

bool
TileBoxes::isSmall(const ElementTile& tile) const
{
  return (limits_.is_most_with_halo ? sizeOf(tile) : tile.own.size()) <= limits_.most;
}

// A half, or a share that makes tiles of nearly the most elements.
std::size_t
TileBoxes::leftSize(std::size_t size) const
{
  if (limits_.is_most_with_halo)
    return size / 2;
  const std::size_t tiles =
      std::max<std::size_t>(2, (size + limits_.most - 1) / limits_.most);
  return size * (tiles / 2) / tiles;
}

// \return the node of the tile
int
TileBoxes::divide(const Eigen::MatrixXf& positions, ElementTile tile,
                  const Visit& visit)
{
  nodes_.emplace_back();
  if (tile.own.empty())
    return addBox(tile, visit);
  const Box bounds = boundsOf(positions, tile.own);
  Eigen::Index axis = 0;
  const float width = bounds.sizes().maxCoeff(&axis);
  if (width == 0.0f || (isSmall(tile) && double(width) <= limits_.widest))
    return addBox(tile, visit);
  std::optional<float> gap;
  if (double(width) > limits_.widest) // the median could divide a compact object
    gap = afterGap(positions, tile.own, axis, reach_);
  const float middle = gap ? *gap
                           : middleOf(positions, tile.own, axis, bounds.min()[axis],
                                      leftSize(tile.own.size()));
  ElementTile left, right;
  for (const pcl::index_t i : tile.own)
    (positions(axis, i) < middle ? left : right).own.push_back(i);
  ParallelGuard guard;
#pragma omp parallel for schedule(static, 1)
  for (int side = 0; side < 2; ++side)
    guard.run([&] {
      ElementTile& half = side == 0 ? left : right;
      half.halo =
          haloOf(positions, half.own, side == 0 ? right.own : left.own, tile.halo);
    });
  guard.rethrow();
  if (double(sizeOf(left) + sizeOf(right)) >
      2.0 * limits_.worthwhile * double(sizeOf(tile)))
    return addBox(tile, visit);
  tile = ElementTile(); // its memory is needed
  const std::size_t node = nodes_.size() - 1;
  nodes_[node].axis = axis;
  nodes_[node].middle = middle;
  const int left_node = divide(positions, std::move(left), visit);
  nodes_[node].left = left_node;
  const int right_node = divide(positions, std::move(right), visit);
  nodes_[node].right = right_node;
  return int(node);
}

pcl::Indices
TileBoxes::haloOf(const Eigen::MatrixXf& positions, const pcl::Indices& own,
                  const pcl::Indices& other, const pcl::Indices& halo) const
{
  const Box bounds = boundsOf(positions, own);
  const Eigen::ArrayXf low = bounds.min().array() - reach_;
  const Eigen::ArrayXf high = bounds.max().array() + reach_;
  pcl::Indices near;
  for (const pcl::Indices* elements : {&other, &halo})
    for (const pcl::index_t i : *elements)
      if ((positions.col(i).array() >= low).all() &&
          (positions.col(i).array() <= high).all())
        near.push_back(i);
  return near;
}

void
forEachTile(const Eigen::MatrixXf& positions, const TileLimits& limits,
            const TileBoxes::Visit& visit)
{
  const TileBoxes boxes(positions, limits, visit);
}

} // namespace pcl_semantic
