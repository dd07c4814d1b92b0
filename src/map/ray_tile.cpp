// SPDX-License-Identifier: BSD-3-Clause
#include "ray_tile.h"

#include <algorithm>
#include <numeric>

namespace pcl_semantic {

void
RayTile::set(const DirectedRay* const* rays, std::size_t count)
{
  sortByLeaf(rays, count);
  makeLevels();
}

inline RayTile::Outermost
RayTile::outermostOf(std::size_t ray) const
{
  const float u = rays_.slopes[0][ray], v = rays_.slopes[1][ray];
  Outermost ends;
  ends.outward = {-u, u, -v, v, -u - v, u - v, v - u, u + v};
  ends.row_slope.fill(u);
  ends.column_slope.fill(v);
  ends.end_slab.fill(rays_.numbers[kEndSlab][ray]);
  ends.longest = rays_.numbers[kEndSlab][ray];
  return ends;
}

void
RayTile::sortByLeaf(const DirectedRay* const* rays, std::size_t count)
{
  rays_.reserve(count);
  rays_.count = count;
  leaf_.resize(count);
  std::array<std::uint32_t, (1 << (2 * kLeafBits)) + 1> next{};
  for (std::size_t i = 0; i < count; ++i)
    ++next[rays[i]->leaf + 1u];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::size_t i = 0; i < count; ++i) {
    const DirectedRay& ray = *rays[i];
    const std::size_t to = next[ray.leaf]++;
    rays_.slopes[0][to] = ray.row_slope;
    rays_.slopes[1][to] = ray.column_slope;
    rays_.numbers[kEndSlab][to] = ray.end_slab;
    rays_.numbers[kEndRow][to] = ray.end_row;
    rays_.numbers[kEndColumn][to] = ray.end_column;
    rays_.numbers[kPoint][to] = std::int32_t(ray.point);
    leaf_[to] = ray.leaf;
  }
}

inline void
RayTile::Outermost::take(const Outermost& other)
{
  for (std::size_t k = 0; k < directions; ++k) { // the loop that compilers make wide
    const bool further = other.outward[k] > outward[k];
    outward[k] = further ? other.outward[k] : outward[k];
    row_slope[k] = further ? other.row_slope[k] : row_slope[k];
    column_slope[k] = further ? other.column_slope[k] : column_slope[k];
    end_slab[k] = further ? other.end_slab[k] : end_slab[k];
  }
  longest = std::max(longest, other.longest);
}

void
RayTile::makeLevels()
{
  outermost_.resize(std::size_t(1) << (2 * kLeafBits));
  std::size_t count = rays_.count; // of parts: at first each ray is one
  for (BundleRows& level : levels_) {
    const bool of_rays = &level == &levels_.front();
    const int shift = of_rays ? 0 : 2;
    level.count = 0;
    level.reserve(count);
    for (std::size_t i = 0; i < count;) {
      const std::size_t begin = i;
      const auto leaf = std::uint16_t(leaf_[i] >> shift);
      Outermost all = of_rays ? outermostOf(i) : outermost_[i];
      for (++i; i < count && leaf_[i] >> shift == leaf; ++i)
        all.take(of_rays ? outermostOf(i) : outermost_[i]);
      leaf_[level.count] = leaf;
      outermost_[level.count] = all;
      addTo(level, all, begin, i);
    }
    count = level.count;
  }
}

void
RayTile::addTo(BundleRows& level, const Outermost& rays, std::size_t begin,
               std::size_t end)
{
  const std::size_t to = level.count++;
  for (std::size_t k = 0; k < 2; ++k) {
    level.slopes[k][to] = rays.row_slope[k];
    level.slopes[2 + k][to] = rays.column_slope[2 + k];
  }
  for (std::size_t corner = 0; corner < 4; ++corner) {
    level.slopes[4 + corner][to] = rays.row_slope[4 + corner];
    level.slopes[8 + corner][to] = rays.column_slope[4 + corner];
  }
  level.numbers[kLongest][to] = rays.longest;
  level.numbers[kReach][to] =
      *std::min_element(rays.end_slab.begin(), rays.end_slab.end());
  level.numbers[kBegin][to] = std::int32_t(begin);
  level.numbers[kEnd][to] = std::int32_t(end);
}

kernels::RayView
columnsOf(const RayRows& rays)
{
  return {rays.slopes[0].data(), rays.slopes[1].data(), rays.numbers[kEndSlab].data(),
          rays.numbers[kEndRow].data(), rays.numbers[kEndColumn].data()};
}

kernels::BundleView
columnsOf(const BundleRows& bundles)
{
  kernels::BundleView view{bundles.slopes[0].data(),
                           bundles.slopes[1].data(),
                           bundles.slopes[2].data(),
                           bundles.slopes[3].data(),
                           {},
                           {},
                           bundles.numbers[kLongest].data(),
                           bundles.numbers[kReach].data()};
  for (std::size_t corner = 0; corner < 4; ++corner) {
    view.corner_row[corner] = bundles.slopes[4 + corner].data();
    view.corner_column[corner] = bundles.slopes[8 + corner].data();
  }
  return view;
}

} // namespace pcl_semantic
