// SPDX-License-Identifier: BSD-3-Clause
#include "point_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr Eigen::Index neighbours = 4;

// Hash of the position, so that the sample depends neither on the order of the points
// nor, because positions are rounded to `step`, on the last bits of single precision.
std::uint64_t
hashOf(const Eigen::Ref<const Eigen::VectorXf>& position, float step)
{
  std::uint64_t hash = 0x9e3779b97f4a7c15u;
  for (const float coordinate : position) {
    const auto steps = std::int64_t(std::floor(coordinate / step));
    hash = (hash ^ std::uint64_t(steps)) * 0xbf58476d1ce4e5b9u;
    hash ^= hash >> 29;
  }
  return hash;
}

// A power of two; about 16,000 steps reach the farthest position.
float
stepOf(const Eigen::MatrixXf& positions)
{
  const float farthest = positions.cwiseAbs().maxCoeff();
  return farthest > 0.0f ? std::ldexp(1.0f, std::ilogb(farthest) - 13) : 1.0f;
}

std::vector<Eigen::Index>
sampleOf(const Eigen::MatrixXf& positions, std::size_t count)
{
  std::vector<std::pair<std::uint64_t, Eigen::Index>> hashes;
  hashes.reserve(std::size_t(positions.cols()));
  const float step = stepOf(positions);
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    hashes.emplace_back(hashOf(positions.col(i), step), i);
  count = std::min(count, hashes.size());
  std::nth_element(hashes.begin(), hashes.begin() + std::ptrdiff_t(count) - 1,
                   hashes.end());
  std::vector<Eigen::Index> sample;
  for (std::size_t k = 0; k < count; ++k)
    sample.push_back(hashes[k].second);
  return sample;
}

struct Reach {
  float nearest, fourth; // distances to the nearest and fourth nearest other point
};

// Coordinates are stored by axis so that the loop over distances vectorises.
Reach
reachOf(const Eigen::MatrixXf& axes, Eigen::Index point)
{
  constexpr Eigen::Index chunk = 64;
  std::array<float, neighbours + 1> nearest; // including the point itself
  nearest.fill(std::numeric_limits<float>::max());
  Eigen::Array<float, chunk, 1> squares;
  for (Eigen::Index begin = 0; begin < axes.rows(); begin += chunk) {
    const Eigen::Index size = std::min(chunk, axes.rows() - begin);
    auto part = squares.head(size);
    part.setZero();
    for (Eigen::Index axis = 0; axis < axes.cols(); ++axis)
      part +=
          (axes.col(axis).segment(begin, size).array() - axes(point, axis)).square();
    if (part.minCoeff() >= nearest.back())
      continue;
    for (float distance : part)
      for (float& kept : nearest)
        if (distance < kept)
          std::swap(distance, kept);
  }
  return {std::sqrt(nearest[1]), std::sqrt(nearest.back())};
}

float
medianOf(std::vector<float> values)
{
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace

float
pointSpacing(const Eigen::MatrixXf& positions)
{
  if (positions.cols() <= neighbours)
    return 0.0f;
  constexpr Eigen::Index distances = 1 << 25; // limits the run time
  const std::vector<Eigen::Index> sample = sampleOf(
      positions,
      std::size_t(std::clamp<Eigen::Index>(distances / positions.cols(), 64, 256)));
  const Eigen::MatrixXf axes = positions.transpose();
  std::vector<float> nearest(sample.size()), fourth(sample.size());
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t k = 0; k < sample.size(); ++k) {
    const Reach reach = reachOf(axes, sample[k]);
    nearest[k] = reach.nearest;
    fourth[k] = reach.fourth;
  }
  // In a regular grid many nearest neighbours are at the same distance.
  const float step = medianOf(nearest);
  const auto alike = std::count_if(nearest.begin(), nearest.end(), [&](float distance) {
    return std::abs(distance - step) <= 0.01f * step;
  });
  return step > 0.0f && 4 * std::size_t(alike) > nearest.size() ? step
                                                                : medianOf(fourth);
}

} // namespace pcl_semantic
