/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "ray_tile.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace pcl_semantic {

namespace {

// Bits of a number of up to 8 bits, with a gap after each.
unsigned
spread(unsigned bits)
{
  bits = (bits | bits << 4) & 0x0F0F;
  bits = (bits | bits << 2) & 0x3333;
  return (bits | bits << 1) & 0x5555;
}

constexpr float huge = std::numeric_limits<float>::max();

// Puts a bundle together from rays or smaller bundles.
class BundleMaker {
public:
  explicit BundleMaker(std::size_t begin)
  {
    bundle_.row_low = bundle_.column_low = huge;
    bundle_.row_high = bundle_.column_high = -huge;
    bundle_.longest = 0;
    bundle_.begin = std::uint32_t(begin);
    corner_.fill(-huge);
  }

  void
  add(const RayBundle& part)
  {
    extend(part.row_low < bundle_.row_low, part.row_low, part, bundle_.row_low, 0);
    extend(part.row_high > bundle_.row_high, part.row_high, part, bundle_.row_high, 1);
    extend(part.column_low < bundle_.column_low, part.column_low, part,
           bundle_.column_low, 2);
    extend(part.column_high > bundle_.column_high, part.column_high, part,
           bundle_.column_high, 3);
    for (int corner = 0; corner < 4; ++corner) {
      const float row = part.corner_row[corner], column = part.corner_column[corner];
      const float outward = (corner & 1 ? row : -row) + (corner & 2 ? column : -column);
      if (extend(outward > corner_[corner], outward, part, corner_[corner],
                 4 + corner)) {
        bundle_.corner_row[corner] = row;
        bundle_.corner_column[corner] = column;
      }
    }
    bundle_.longest = std::max(bundle_.longest, part.longest);
  }

  RayBundle
  finish(std::size_t end)
  {
    bundle_.reach = *std::min_element(reach_.begin(), reach_.end());
    bundle_.end = std::uint32_t(end);
    return bundle_;
  }

private:
  bool
  extend(bool further, float value, const RayBundle& part, float& outermost,
         std::size_t ray)
  {
    if (further) {
      outermost = value;
      reach_[ray] = part.reach;
    }
    return further;
  }

  RayBundle bundle_;
  std::array<float, 4> corner_; // how far outward the rays at the corners go
  std::array<std::int32_t, 8> reach_{};
};

RayBundle
bundleOf(float row_slope, float column_slope, std::int32_t end_slab)
{
  const float u = row_slope, v = column_slope;
  return {u, u, v, v, {u, u, u, u}, {v, v, v, v}, end_slab, end_slab, 0, 0};
}

} // namespace

void
setTile(int face, DirectedRay& ray)
{
  constexpr int bits = kTileBits + kLeafBits;
  const auto place = [](float slope) {
    const int cell = int((slope + 1.0f) * float(1 << (bits - 1)));
    return unsigned(std::clamp(cell, 0, (1 << bits) - 1));
  };
  const unsigned row = place(ray.row_slope), column = place(ray.column_slope);
  const unsigned leaf_mask = (1u << kLeafBits) - 1;
  ray.tile = std::uint16_t(unsigned(face) * kTilesAFace +
                           ((column >> kLeafBits) << kTileBits) + (row >> kLeafBits));
  ray.leaf = std::uint16_t(spread(column & leaf_mask) << 1 | spread(row & leaf_mask));
}

void
RayTile::set(const DirectedRay* const* rays, std::size_t count)
{
  sortByLeaf(rays, count);
  makeLevels();
}

void
RayTile::sortByLeaf(const DirectedRay* const* rays, std::size_t count)
{
  count_ = count;
  const std::size_t room = count + kernels::slab_lanes;
  row_slope_.resize(room);
  column_slope_.resize(room);
  end_slab_.resize(room);
  end_row_.resize(room);
  end_column_.resize(room);
  point_.resize(room);
  leaf_.resize(room);
  std::array<std::uint32_t, (1 << (2 * kLeafBits)) + 1> next{};
  for (std::size_t i = 0; i < count; ++i)
    ++next[rays[i]->leaf + 1u];
  std::partial_sum(next.begin(), next.end(), next.begin());
  for (std::size_t i = 0; i < count; ++i) {
    const DirectedRay& ray = *rays[i];
    const std::size_t to = next[ray.leaf]++;
    row_slope_[to] = ray.row_slope;
    column_slope_[to] = ray.column_slope;
    end_slab_[to] = ray.end_slab;
    end_row_[to] = ray.end_row;
    end_column_[to] = ray.end_column;
    point_[to] = ray.point;
    leaf_[to] = ray.leaf;
  }
}

void
RayTile::makeLevels()
{
  std::vector<std::uint16_t> leaf(leaf_.begin(), leaf_.begin() + long(count_));
  std::vector<RayBundle> parts(count_); // at first each ray is a bundle of its own
  for (std::size_t i = 0; i < count_; ++i)
    parts[i] = bundleOf(row_slope_[i], column_slope_[i], end_slab_[i]);
  for (std::vector<RayBundle>& level : levels_) {
    const int shift = &level == &levels_.front() ? 0 : 2;
    level.clear();
    std::size_t leaves = 0;
    for (std::size_t i = 0; i < parts.size();) {
      const auto number = std::uint16_t(leaf[i] >> shift);
      BundleMaker bundle(i);
      for (; i < parts.size() && leaf[i] >> shift == number; ++i)
        bundle.add(parts[i]);
      level.push_back(bundle.finish(i));
      leaf[leaves++] = number;
    }
    parts = level;
  }
}

kernels::RayView
RayTile::view() const
{
  return {row_slope_.data(), column_slope_.data(), end_slab_.data(), end_row_.data(),
          end_column_.data()};
}

void
RayTile::removeEnded(int slab)
{
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    row_slope_[kept] = row_slope_[i];
    column_slope_[kept] = column_slope_[i];
    end_slab_[kept] = end_slab_[i];
    end_row_[kept] = end_row_[i];
    end_column_[kept] = end_column_[i];
    point_[kept] = point_[i];
    kept += end_slab_[i] >= slab;
  }
  count_ = kept;
}

} // namespace pcl_semantic
