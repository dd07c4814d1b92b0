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

float
medianOf(std::vector<float> values)
{
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace

std::uint64_t
PositionHash::operator()(const Eigen::Vector3f& position) const
{
  // Rounded to about a millimetre, so that the last bits do not matter.
  constexpr double steps = 1024.0; // in a metre
  std::uint64_t hash = 0x9e3779b97f4a7c15u;
  for (int axis = 0; axis < 3; ++axis) {
    const auto bits =
        std::uint64_t(std::llround((double(position[axis]) - low_[axis]) * steps));
    hash = (hash ^ bits) * 0xbf58476d1ce4e5b9u;
    hash ^= hash >> 29;
  }
  return hash;
}

std::vector<Eigen::Index>
sampleByPosition(const Eigen::Matrix3Xf& positions, std::size_t count,
                 const PositionHash& hash)
{
  using Hash = std::pair<std::uint64_t, Eigen::Index>;
  std::vector<Hash> least; // a heap
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    const Hash each(hash(positions.col(i)), i);
    if (least.size() == count && !(count > 0 && each < least.front()))
      continue;
    if (least.size() == count) {
      std::pop_heap(least.begin(), least.end());
      least.pop_back();
    }
    least.push_back(each);
    std::push_heap(least.begin(), least.end());
  }
  std::sort_heap(least.begin(), least.end());
  std::vector<Eigen::Index> sample;
  for (const Hash& each : least)
    sample.push_back(each.second);
  return sample;
}

std::vector<Eigen::Index>
sampleByPosition(const Eigen::Matrix3Xf& positions, std::size_t count)
{
  if (positions.cols() == 0)
    return {};
  return sampleByPosition(positions, count,
                          PositionHash(positions.rowwise().minCoeff()));
}

std::size_t
sizeOfSpacingSample(std::size_t points)
{
  constexpr std::size_t distances = 1 << 25; // limits the run time
  return std::clamp<std::size_t>(distances / std::max<std::size_t>(points, 1), 64, 256);
}

SpacingSample::SpacingSample(const Eigen::Matrix3Xf& points)
    : points_(points), squares_(std::size_t(points.cols()))
{
  for (Squares& squares : squares_)
    squares.fill(std::numeric_limits<float>::max());
}

void
SpacingSample::add(const Eigen::MatrixX3f& axes)
{
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t k = 0; k < squares_.size(); ++k)
    addTo(squares_[k], points_.col(Eigen::Index(k)), axes);
}

// Coordinates are stored by axis so that the loop over distances vectorises.
void
SpacingSample::addTo(Squares& nearest, const Eigen::Vector3f& point,
                     const Eigen::MatrixX3f& axes)
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
pointSpacing(const Eigen::Matrix3Xf& positions, const std::vector<Eigen::Index>& sample)
{
  if (positions.cols() <= SpacingSample::neighbours)
    return 0.0f;
  const std::size_t count =
      std::min(sample.size(), sizeOfSpacingSample(std::size_t(positions.cols())));
  Eigen::Matrix3Xf points(3, Eigen::Index(count));
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    points.col(k) = positions.col(sample[std::size_t(k)]);
  SpacingSample spacing(points);
  spacing.add(positions.transpose());
  return spacing.spacing();
}

float
pointSpacing(const Eigen::Matrix3Xf& positions)
{
  return pointSpacing(
      positions,
      sampleByPosition(positions, sizeOfSpacingSample(std::size_t(positions.cols()))));
}

} // namespace pcl_semantic
