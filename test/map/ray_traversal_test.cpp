// SPDX-License-Identifier: BSD-3-Clause
#include "map/ray_traversal.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <tuple>

namespace {

using namespace pcl_semantic;
using Voxels = std::set<std::tuple<int, int, int>>;
__extension__ typedef __int128 Wide;

constexpr std::int64_t edge = std::int64_t(1) << kQuantizationBits;

// A bound on the time t = numerator / denominator at which a point moves along a
// segment.
struct Bound {
  Wide numerator;
  Wide denominator; // positive
  bool open;
};

// Whether a half-open cube holds a point of the closed segment: each axis allows an
// interval of times, and the intervals have to share one. Rational, no rounding.
bool
crosses(const QuantizedPoint& from, const QuantizedPoint& to, const VoxelIndex& voxel)
{
  std::vector<Bound> lower{{0, 1, false}}, upper{{1, 1, false}};
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t delta = to[axis] - from[axis];
    const std::int64_t low = voxel[axis] * edge - from[axis];
    const std::int64_t high = low + edge;
    if (delta == 0) {
      if (low > 0 || high <= 0)
        return false;
    }
    else if (delta > 0) {
      lower.push_back({low, delta, false});
      upper.push_back({high, delta, true});
    }
    else {
      lower.push_back({-high, -delta, true});
      upper.push_back({-low, -delta, false});
    }
  }
  for (const Bound& a : lower)
    for (const Bound& b : upper) {
      const Wide left = a.numerator * b.denominator;
      const Wide right = b.numerator * a.denominator;
      if (left > right || (left == right && (a.open || b.open)))
        return false;
    }
  return true;
}

Voxels
oracle(const QuantizedPoint& from, const QuantizedPoint& to)
{
  const VoxelIndex low = voxelOf(from.cwiseMin(to)), high = voxelOf(from.cwiseMax(to));
  Voxels voxels;
  for (int z = low.z(); z <= high.z(); ++z)
    for (int y = low.y(); y <= high.y(); ++y)
      for (int x = low.x(); x <= high.x(); ++x)
        if (crosses(from, to, {x, y, z}))
          voxels.insert({x, y, z});
  return voxels;
}

void
expectExact(const QuantizedPoint& from, const QuantizedPoint& to)
{
  Voxels visited;
  std::size_t visits = 0;
  EXPECT_TRUE(traverseSegment(from, to, [&](const VoxelIndex& voxel) {
    visited.insert({voxel.x(), voxel.y(), voxel.z()});
    ++visits;
    return true;
  }));
  EXPECT_EQ(visited, oracle(from, to)) << from.transpose() << " to " << to.transpose();
  EXPECT_EQ(visits, visited.size()) << "a voxel was visited twice";
}

TEST(RayTraversal, EqualsRationalOracleOnRandomSegments)
{
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::int64_t> coordinate(-6 * edge, 6 * edge);
  const auto point = [&]() -> QuantizedPoint {
    return QuantizedPoint(coordinate(random), coordinate(random), coordinate(random));
  };
  for (int i = 0; i < 2000; ++i)
    expectExact(point(), point());
}

TEST(RayTraversal, EqualsRationalOracleThroughEdgesAndCorners)
{
  // Coordinates at multiples of half a voxel: ties of two and three axes, segments
  // along axes and in the planes between voxels.
  std::mt19937_64 random(2);
  std::uniform_int_distribution<std::int64_t> coordinate(-6, 6);
  const auto point = [&]() -> QuantizedPoint {
    return QuantizedPoint(coordinate(random), coordinate(random), coordinate(random)) *
           (edge / 2);
  };
  for (int i = 0; i < 4000; ++i)
    expectExact(point(), point());
}

TEST(RayTraversal, LongSegmentsUseTheWidePathAndAgree)
{
  // Longer than 1024 voxels in one axis, thin in the others, so that the oracle's box
  // stays small.
  std::mt19937_64 random(3);
  std::uniform_int_distribution<std::int64_t> small(-2 * edge, 2 * edge);
  for (int i = 0; i < 20; ++i) {
    const QuantizedPoint from(small(random), small(random), small(random));
    expectExact(from,
                from + QuantizedPoint(1500 * edge + 77, small(random), small(random)));
    expectExact(from,
                from - QuantizedPoint(small(random), 1500 * edge + 3, small(random)));
  }
}

TEST(RayTraversal, FarFromTheOriginNothingChanges)
{
  const QuantizedPoint far(std::int64_t(900000000) * edge,
                           -std::int64_t(900000000) * edge, 7);
  std::mt19937_64 random(4);
  std::uniform_int_distribution<std::int64_t> coordinate(-3 * edge, 3 * edge);
  for (int i = 0; i < 100; ++i) {
    const QuantizedPoint delta(coordinate(random), coordinate(random),
                               coordinate(random));
    expectExact(far, far + delta);
  }
}

// The part from each slab on along each axis, against the whole traversal.
void
expectPartsOfTheWhole(const QuantizedPoint& from, const QuantizedPoint& to)
{
  for (int axis = 0; axis < 3; ++axis) {
    if (from[axis] == to[axis])
      continue;
    const int start = voxelOf(from)[axis];
    const int length = std::abs(voxelOf(to)[axis] - start);
    for (int slab = 0; slab <= length + 2; ++slab) {
      std::vector<VoxelIndex> part, expected;
      traverseSegment(from, to, [&](const VoxelIndex& voxel) {
        if (std::abs(voxel[axis] - start) >= slab)
          expected.push_back(voxel);
        return true;
      });
      traverseSegmentFrom(from, to, axis, slab, [&](const VoxelIndex& voxel) {
        part.push_back(voxel);
        return true;
      });
      EXPECT_EQ(part, expected) << from.transpose() << " to " << to.transpose()
                                << ", axis " << axis << ", slab " << slab;
    }
  }
}

TEST(RayTraversal, BeginsAtAnySlab)
{
  std::mt19937_64 random(5);
  std::uniform_int_distribution<std::int64_t> anywhere(-6 * edge, 6 * edge),
      halves(-6, 6);
  for (int i = 0; i < 1000; ++i) {
    const auto point = [&](auto& coordinate, std::int64_t unit) -> QuantizedPoint {
      return QuantizedPoint(coordinate(random), coordinate(random),
                            coordinate(random)) *
             unit;
    };
    expectPartsOfTheWhole(point(anywhere, 1), point(anywhere, 1));
    expectPartsOfTheWhole(point(halves, edge / 2), point(halves, edge / 2));
  }
  expectPartsOfTheWhole({5, 6, 7}, {-1500 * edge, 100 * edge, 3});
}

TEST(RayTraversal, StopsWhenTheVisitorSaysSo)
{
  int visits = 0;
  EXPECT_FALSE(traverseSegment(QuantizedPoint(0, 0, 0), QuantizedPoint(9 * edge, 0, 0),
                               [&](const VoxelIndex&) { return ++visits < 3; }));
  EXPECT_EQ(visits, 3);
}

} // namespace
