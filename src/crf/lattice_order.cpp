// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_order.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t part_size = 8192; // of what threads count at a time
constexpr std::size_t tile_points = 2048;

std::size_t
partsOf(std::size_t count)
{
  return (count + part_size - 1) / part_size;
}

struct Bounds {
  float low[kernels::most_dimensions];
  float high[kernels::most_dimensions];
  bool finite;
};

Bounds
boundsOf(const LatticeFeatures& features, std::size_t begin, std::size_t end)
{
  const auto d = std::size_t(features.rows());
  Bounds bounds;
  float zero = 0.0f;
  std::copy_n(features.col(Eigen::Index(begin)).data(), d, bounds.low);
  std::copy_n(bounds.low, d, bounds.high);
  for (std::size_t i = begin; i < end; ++i) {
    const float* const feature = features.col(Eigen::Index(i)).data();
    for (std::size_t k = 0; k < d; ++k) {
      bounds.low[k] = std::min(bounds.low[k], feature[k]);
      bounds.high[k] = std::max(bounds.high[k], feature[k]);
      zero += 0.0f * feature[k]; // not a number, if one is not or is infinite
    }
  }
  bounds.finite = zero == 0.0f;
  return bounds;
}

} // namespace

LatticeBuckets::LatticeBuckets(const LatticeArray<std::int32_t>& bucket_of,
                               std::size_t buckets)
    : members(bucket_of.size()), begins(buckets + 1, 0)
{
  const std::size_t count = bucket_of.size(), parts = partsOf(count);
  // Members of each bucket in each part, then where the first of them goes.
  std::vector<std::size_t> places(parts * buckets, 0);
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < parts; ++p)
    for (std::size_t i = p * part_size; i < std::min(count, (p + 1) * part_size); ++i)
      ++places[p * buckets + std::size_t(bucket_of[i])];
  std::size_t sum = 0;
  for (std::size_t b = 0; b < buckets; ++b) {
    begins[b] = sum;
    for (std::size_t p = 0; p < parts; ++p) {
      const std::size_t members_here = places[p * buckets + b];
      places[p * buckets + b] = sum;
      sum += members_here;
    }
  }
  begins[buckets] = sum;
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < parts; ++p)
    for (std::size_t i = p * part_size; i < std::min(count, (p + 1) * part_size); ++i)
      members[places[p * buckets + std::size_t(bucket_of[i])]++] = std::int32_t(i);
}

kernels::LatticeFrame
frameOf(const LatticeFeatures& features, double* extents)
{
  const auto d = std::size_t(features.rows());
  if (d < 1 || d > std::size_t(kernels::most_dimensions))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "points have " << d << " features, expected 1 to "
                                       << kernels::most_dimensions);
  const auto count = std::size_t(features.cols()), parts = partsOf(count);
  std::vector<Bounds> bounds(parts);
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < parts; ++p)
    bounds[p] = boundsOf(features, p * part_size, std::min(count, (p + 1) * part_size));
  kernels::LatticeFrame frame = {};
  frame.dimensions = int(d);
  for (std::size_t k = 0; k < d; ++k) {
    float low = parts > 0 ? bounds[0].low[k] : 0.0f, high = low;
    for (const Bounds& part : bounds) {
      if (!part.finite)
        PCL_THROW_EXCEPTION(InvalidParameterException, "a feature is not finite");
      low = std::min(low, part.low[k]);
      high = std::max(high, part.high[k]);
    }
    // Features often lie on a grid: with its corner at that of the lattice they would
    // lie between simplices, and rounding would choose.
    const double offset = std::fmod(0.618033988749895 * double(k + 1), 1.0);
    frame.low[k] = double(low) - offset;
    extents[k] = double(high) - frame.low[k];
    frame.scale[k + 1] = std::sqrt(2.0 / (3.0 * double(k + 1) * double(k + 2)));
    constexpr double most = double(1 << 28);
    if (extents[k] > most)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "feature " << k << " spans " << extents[k]
                                     << " deviations, expected at most " << most);
  }
  return frame;
}

LatticeArray<std::int32_t>
orderInTiles(const LatticeFeatures& features, const kernels::LatticeFrame& frame,
             const double* extents)
{
  const auto count = std::size_t(features.cols());
  const double tiles = std::max(1.0, double(count) / double(tile_points));
  const bool flat = frame.dimensions > 1;
  const double area = extents[0] * (flat ? extents[1] : 1.0);
  const double edge = flat ? std::sqrt(area / tiles) : area / tiles;
  const auto along = [&](int k) {
    const double most = double(count / tile_points + 1);
    return edge > 0.0 ? std::clamp(std::ceil(extents[k] / edge), 1.0, most) : 1.0;
  };
  const double across = along(0), down = flat ? along(1) : 1.0;
  const auto tile = [&](float feature, int k, double number) {
    const double place = (double(feature) - frame.low[k]) / extents[k] * number;
    return extents[k] > 0.0 ? std::min(std::int32_t(place), std::int32_t(number) - 1)
                            : 0;
  };
  LatticeArray<std::int32_t> tile_of(count);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < count; ++i) {
    const float* const feature = features.col(Eigen::Index(i)).data();
    const std::int32_t row = flat ? tile(feature[1], 1, down) : 0;
    tile_of[i] = row * std::int32_t(across) + tile(feature[0], 0, across);
  }
  return std::move(LatticeBuckets(tile_of, std::size_t(across * down)).members);
}

} // namespace pcl_semantic
