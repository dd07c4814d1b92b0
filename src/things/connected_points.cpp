// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/connected_points.h>

#include "core/disjoint_sets.h"
#include "core/fail.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace pcl_semantic {

namespace {

constexpr int kBits = 21; // of a coordinate of a cube, with room for its neighbours
constexpr int kReach = 2; // cubes that a gap can span: sqrt(3) edges

using CubeKey = std::uint64_t; // in the order z, y, x

CubeKey
keyOf(const Eigen::Vector3i& cube)
{
  const auto part = [&](int axis) { return CubeKey(cube[axis] + kReach); };
  return part(2) << 2 * kBits | part(1) << kBits | part(0);
}

Eigen::Vector3i
cubeOf(CubeKey key)
{
  const auto part = [&](int axis) {
    return int(key >> axis * kBits & ((1u << kBits) - 1)) - kReach;
  };
  return {part(0), part(1), part(2)};
}

bool
isLower(const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// A cube with points: a range of the sorted positions.
struct Cube {
  CubeKey key;
  std::size_t first, last;
  Eigen::AlignedBox3d box;
};

class Cubes {
public:
  Cubes(const std::vector<Eigen::Vector3d>& points, double gap)
      : squared_gap_(gap * gap), order_(points.size()), keys_(points.size())
  {
    sort(points, gap);
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const CubeKey key = keys_[order_[i]];
      if (cubes_.empty() || cubes_.back().key != key)
        cubes_.push_back({key, i, i, {}});
      cubes_.back().last = i + 1;
      positions_.push_back(points[order_[i]]);
      cubes_.back().box.extend(positions_.back());
    }
  }

  /** \brief The root of each point's cube. */
  std::vector<int>
  connect()
  {
    DisjointSets sets;
    sets.grow(cubes_.size());
    for (std::size_t c = 0; c < cubes_.size(); ++c)
      forEachLaterNeighbour(c, [&](std::size_t other) {
        if (sets.rootOf(int(c)) != sets.rootOf(int(other)) &&
            areNear(cubes_[c], cubes_[other]))
          sets.joinMembers(int(c), int(other));
      });
    std::vector<int> roots(order_.size());
    for (std::size_t c = 0; c < cubes_.size(); ++c)
      for (std::size_t i = cubes_[c].first; i < cubes_[c].last; ++i)
        roots[order_[i]] = sets.rootOf(int(c));
    return roots;
  }

private:
  void
  sort(const std::vector<Eigen::Vector3d>& points, double gap)
  {
    // A little smaller, so that rounding cannot separate the points of a cube.
    const double edge = gap / std::sqrt(3.0) * (1.0 - 1e-9);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& point : points)
      box.extend(point);
    if (!points.empty() && !(box.sizes().maxCoeff() / edge < double(1 << (kBits - 1))))
      badInput("objects extend over ", box.sizes().maxCoeff(), " m, expected at most ",
               double(1 << (kBits - 1)) * edge, " m for a gap of ", gap, " m");
    for (std::size_t i = 0; i < points.size(); ++i)
      keys_[i] = keyOf(((points[i] - box.min()) / edge).cast<int>());
    std::iota(order_.begin(), order_.end(), std::size_t(0));
    std::sort(order_.begin(), order_.end(),
              [&](std::size_t a, std::size_t b) { return keys_[a] < keys_[b]; });
  }

  // Visits the cubes within kReach of a cube that are after it in the order.
  template <typename Visit>
  void
  forEachLaterNeighbour(std::size_t c, Visit&& visit) const
  {
    const Eigen::Vector3i cube = cubeOf(cubes_[c].key);
    const auto visitRow = [&](int y, int z, int first_x) {
      const auto key = [&](int x) { return keyOf(cube + Eigen::Vector3i(x, y, z)); };
      auto found = std::lower_bound(
          cubes_.begin() + std::ptrdiff_t(c) + 1, cubes_.end(), key(first_x),
          [](const Cube& each, CubeKey value) { return each.key < value; });
      for (; found != cubes_.end() && found->key <= key(kReach); ++found)
        visit(std::size_t(found - cubes_.begin()));
    };
    visitRow(0, 0, 1);
    for (int y = 1; y <= kReach; ++y)
      visitRow(y, 0, -kReach);
    for (int z = 1; z <= kReach; ++z)
      for (int y = -kReach; y <= kReach; ++y)
        visitRow(y, z, -kReach);
  }

  bool
  areNear(const Cube& a, const Cube& b) const
  {
    if (a.box.squaredExteriorDistance(b.box) > squared_gap_)
      return false;
    for (std::size_t i = a.first; i < a.last; ++i) {
      if (b.box.squaredExteriorDistance(positions_[i]) > squared_gap_)
        continue;
      for (std::size_t j = b.first; j < b.last; ++j)
        if ((positions_[i] - positions_[j]).squaredNorm() <= squared_gap_)
          return true;
    }
    return false;
  }

  double squared_gap_;
  std::vector<std::size_t> order_;         // points by cube
  std::vector<CubeKey> keys_;              // of the points
  std::vector<Eigen::Vector3d> positions_; // in this order
  std::vector<Cube> cubes_;
};

// Numbers the components by their lowest points.
std::vector<int>
numbered(std::vector<int> roots, const std::vector<Eigen::Vector3d>& points)
{
  constexpr std::size_t none = SIZE_MAX;
  std::vector<std::size_t> lowest(roots.size(), none); // point, by root
  const auto reversed = [&](std::size_t i) { return points[i].reverse().eval(); };
  std::vector<int> components;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    std::size_t& low = lowest[std::size_t(roots[i])];
    if (low == none)
      components.push_back(roots[i]);
    if (low == none || isLower(reversed(i), reversed(low)))
      low = i;
  }
  std::sort(components.begin(), components.end(), [&](int a, int b) {
    return isLower(reversed(lowest[std::size_t(a)]), reversed(lowest[std::size_t(b)]));
  });
  std::vector<int> numbers(roots.size());
  for (std::size_t c = 0; c < components.size(); ++c)
    numbers[std::size_t(components[c])] = int(c);
  for (int& root : roots)
    root = numbers[std::size_t(root)];
  return roots;
}

} // namespace

std::vector<int>
connectedComponents(const std::vector<Eigen::Vector3d>& points, double gap)
{
  if (!(gap > 0.0 && std::isfinite(gap)))
    badParameter("gap of objects: ", gap, " m, expected a positive number");
  return numbered(Cubes(points, gap).connect(), points);
}

} // namespace pcl_semantic
