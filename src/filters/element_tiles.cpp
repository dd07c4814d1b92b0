// SPDX-License-Identifier: BSD-3-Clause
#include "element_tiles.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

class TileDivision {
public:
  TileDivision(const Eigen::MatrixXf& positions, double reach, std::size_t most,
               const std::function<void(const ElementTile&)>& visit)
      : positions_(positions), reach_(float(reach)), most_(most), visit_(visit)
  {}

  void
  divide(ElementTile tile) const
  {
    if (tile.own.empty())
      return;
    const Box box = boxOf(tile.own);
    Eigen::Index axis = 0;
    const float length = box.sizes().maxCoeff(&axis);
    if (tile.own.size() <= most_ || length == 0.0f)
      return visit_(tile);
    const float middle = middleOf(tile.own, axis, box.min()[axis]);
    ElementTile left, right;
    for (const pcl::index_t i : tile.own)
      (positions_(axis, i) < middle ? left : right).own.push_back(i);
    left.halo = haloOf(left.own, right.own, tile.halo);
    right.halo = haloOf(right.own, left.own, tile.halo);
    if (sizeOf(left) > kWorthwhile * sizeOf(tile) ||
        sizeOf(right) > kWorthwhile * sizeOf(tile))
      return visit_(tile);
    tile = ElementTile(); // its memory is needed
    divide(std::move(left));
    divide(std::move(right));
  }

private:
  using Box = Eigen::AlignedBox<float, Eigen::Dynamic>;

  Box
  boxOf(const pcl::Indices& elements) const
  {
    Box box(positions_.rows());
    for (const pcl::index_t i : elements)
      box.extend(positions_.col(i));
    return box;
  }

  // Largest part of a tile and its halo that a half of it may need.
  static constexpr double kWorthwhile = 0.75;

  static double
  sizeOf(const ElementTile& tile)
  {
    return double(tile.own.size() + tile.halo.size());
  }

  // The median, or the least value above the lowest one.
  float
  middleOf(const pcl::Indices& elements, Eigen::Index axis, float low) const
  {
    std::vector<float> values;
    values.reserve(elements.size());
    for (const pcl::index_t i : elements)
      values.push_back(positions_(axis, i));
    const auto median = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), median, values.end());
    if (*median > low)
      return *median;
    float least = HUGE_VALF;
    for (const float value : values)
      if (value > low)
        least = std::min(least, value);
    return least;
  }

  pcl::Indices
  haloOf(const pcl::Indices& own, const pcl::Indices& other,
         const pcl::Indices& halo) const
  {
    const Box box = boxOf(own);
    const Eigen::ArrayXf low = box.min().array() - reach_;
    const Eigen::ArrayXf high = box.max().array() + reach_;
    pcl::Indices near;
    for (const pcl::Indices* elements : {&other, &halo})
      for (const pcl::index_t i : *elements)
        if ((positions_.col(i).array() >= low).all() &&
            (positions_.col(i).array() <= high).all())
          near.push_back(i);
    return near;
  }

  const Eigen::MatrixXf& positions_;
  const float reach_;
  const std::size_t most_;
  const std::function<void(const ElementTile&)>& visit_;
};

} // namespace

void
forEachTile(const Eigen::MatrixXf& positions, double reach, std::size_t most,
            const std::function<void(const ElementTile&)>& visit)
{
  ElementTile all;
  all.own.resize(std::size_t(positions.cols()));
  std::iota(all.own.begin(), all.own.end(), 0);
  TileDivision(positions, reach, most, visit).divide(std::move(all));
}

} // namespace pcl_semantic
