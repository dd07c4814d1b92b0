// SPDX-License-Identifier: BSD-3-Clause
#include "point_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace pcl_semantic {

namespace {

std::uint64_t
hashOf(const Eigen::Ref<const Eigen::VectorXf>& position, float step)
{
  std::uint64_t hash = 0x9e3779b97f4a7c15u;
  for (const float coordinate : position) {
    std::uint64_t bits = 0;
    if (step > 0.0f)
      bits = std::uint64_t(std::int64_t(std::floor(coordinate / step)));
    else
      std::memcpy(&bits, &coordinate, sizeof(coordinate));
    hash = (hash ^ bits) * 0xbf58476d1ce4e5b9u;
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

float
medianOf(std::vector<float> values)
{
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace

std::vector<Eigen::Index>
sampleByPosition(const Eigen::Ref<const Eigen::MatrixXf>& positions, std::size_t count,
                 float step)
{
  std::vector<std::pair<std::uint64_t, Eigen::Index>> hashes;
  hashes.reserve(std::size_t(positions.cols()));
  for (Eigen::Index i = 0; i < positions.cols(); ++i)
    hashes.emplace_back(hashOf(positions.col(i), step), i);
  count = std::min(count, hashes.size());
  std::partial_sort(hashes.begin(), hashes.begin() + std::ptrdiff_t(count),
                    hashes.end());
  std::vector<Eigen::Index> sample;
  for (std::size_t k = 0; k < count; ++k)
    sample.push_back(hashes[k].second);
  return sample;
}

SpacingSample::SpacingSample(const Eigen::MatrixXf& points)
    : points_(points), squares_(std::size_t(points.cols()))
{
  for (Squares& squares : squares_)
    squares.fill(std::numeric_limits<float>::max());
}

void
SpacingSample::add(const Eigen::MatrixXf& axes)
{
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t k = 0; k < squares_.size(); ++k)
    addTo(squares_[k], points_.col(Eigen::Index(k)), axes);
}

// Coordinates are stored by axis so that the loop over distances vectorises.
void
SpacingSample::addTo(Squares& nearest, const Eigen::VectorXf& point,
                     const Eigen::MatrixXf& axes)
{
  constexpr Eigen::Index chunk = 64;
  Eigen::Array<float, chunk, 1> squares;
  for (Eigen::Index begin = 0; begin < axes.rows(); begin += chunk) {
    const Eigen::Index size = std::min(chunk, axes.rows() - begin);
    auto part = squares.head(size);
    part.setZero();
    for (Eigen::Index axis = 0; axis < axes.cols(); ++axis)
      part += (axes.col(axis).segment(begin, size).array() - point[axis]).square();
    if (part.minCoeff() >= nearest.back())
      continue;
    for (float distance : part)
      for (float& kept : nearest)
        if (distance < kept)
          std::swap(distance, kept);
  }
}

float
SpacingSample::spacing() const
{
  std::vector<float> nearest, fourth;
  for (const Squares& squares : squares_) {
    nearest.push_back(std::sqrt(squares[1]));
    fourth.push_back(std::sqrt(squares.back()));
  }
  // In a regular grid many nearest neighbours are at the same distance.
  const float step = medianOf(nearest);
  const auto alike = std::count_if(nearest.begin(), nearest.end(), [&](float distance) {
    return std::abs(distance - step) <= 0.01f * step;
  });
  return step > 0.0f && 4 * std::size_t(alike) > nearest.size() ? step
                                                                : medianOf(fourth);
}

float
pointSpacing(const Eigen::MatrixXf& positions)
{
  if (positions.cols() <= SpacingSample::neighbours)
    return 0.0f;
  constexpr Eigen::Index distances = 1 << 25; // limits the run time
  const std::vector<Eigen::Index> sample = sampleByPosition(
      positions,
      std::size_t(std::clamp<Eigen::Index>(distances / positions.cols(), 64, 256)),
      stepOf(positions));
  Eigen::MatrixXf points(positions.rows(), Eigen::Index(sample.size()));
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    points.col(k) = positions.col(sample[std::size_t(k)]);
  SpacingSample spacing(points);
  spacing.add(positions.transpose());
  return spacing.spacing();
}

} // namespace pcl_semantic
