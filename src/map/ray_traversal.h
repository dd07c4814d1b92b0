// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <limits>
#include <pcl_semantic/core/voxel_index.h>

namespace pcl_semantic {

namespace detail {

__extension__ typedef __int128 Int128;

// One axis of the traversal. Times along the segment are integers, in units of the
// whole segment divided by twice the product of all extents. A step in the negative
// direction leaves its half-open voxel only after the boundary: half a unit later.
template <typename Integer> struct TraversalAxis {
  Integer next; // time of the next boundary
  Integer step; // time between boundaries

  TraversalAxis(std::int64_t from, std::int64_t delta, Integer product)
  {
    constexpr std::int64_t edge = std::int64_t(1) << kQuantizationBits;
    if (delta == 0) {
      next = std::numeric_limits<std::int64_t>::max();
      if (sizeof(Integer) > 8)
        next = next << 62;
      step = 0;
      return;
    }
    const std::int64_t inside = from & (edge - 1);
    const Integer unit = 2 * (product / Integer(std::llabs(delta)));
    next = delta > 0 ? unit * Integer(edge - inside) : unit * Integer(inside) + 1;
    step = unit * Integer(edge);
  }

  // Passes the boundaries up to a time; returns their number.
  int
  skipTo(Integer time)
  {
    if (step == 0 || next > time)
      return 0;
    const Integer passed = (time - next) / step + 1;
    next += passed * step;
    return static_cast<int>(passed);
  }
};

// Visits voxels that are entered at the same time as slab \a slab along \a axis or
// later.
template <typename Integer, typename Visit>
bool
traverse(const QuantizedPoint& from, const QuantizedPoint& delta, int axis, int slab,
         Visit& visit)
{
  Integer product = 1;
  for (int a = 0; a < 3; ++a)
    if (delta[a] != 0)
      product *= Integer(std::llabs(delta[a]));
  const Integer end = 2 * product;
  TraversalAxis<Integer> x(from.x(), delta.x(), product);
  TraversalAxis<Integer> y(from.y(), delta.y(), product);
  TraversalAxis<Integer> z(from.z(), delta.z(), product);
  const int sx = delta.x() > 0 ? 1 : -1;
  const int sy = delta.y() > 0 ? 1 : -1;
  const int sz = delta.z() > 0 ? 1 : -1;
  VoxelIndex voxel = voxelOf(from);
  if (slab > 0) {
    const TraversalAxis<Integer>& along = axis == 0 ? x : axis == 1 ? y : z;
    if ((std::llabs(delta[axis]) >> kQuantizationBits) + 1 < slab)
      return true;
    const Integer begin = along.next + along.step * Integer(slab - 1);
    if (begin > end)
      return true;
    voxel.x() += sx * x.skipTo(begin);
    voxel.y() += sy * y.skipTo(begin);
    voxel.z() += sz * z.skipTo(begin);
  }
  while (true) {
    if (!visit(static_cast<const VoxelIndex&>(voxel)))
      return false;
    const Integer yz = y.next < z.next ? y.next : z.next;
    const Integer now = x.next < yz ? x.next : yz;
    if (now > end)
      return true;
    if (x.next == now) {
      voxel.x() += sx;
      x.next += x.step;
    }
    if (y.next == now) {
      voxel.y() += sy;
      y.next += y.step;
    }
    if (z.next == now) {
      voxel.z() += sz;
      z.next += z.step;
    }
  }
}

} // namespace detail

/** \brief Visits the voxels that the closed segment crosses, starting with the first
 * one in slab \a slab, \a slab voxels from the start along \a axis. Ordered and exact
 * as traverseSegment(); visits nothing if the segment ends before.
 * \param[in] axis 0, 1 or 2; the segment has an extent along it unless \a slab is 0
 * \param[in] visit called with a VoxelIndex; returns false to stop
 * \return false if \a visit stopped it */
template <typename Visit>
bool
traverseSegmentFrom(const QuantizedPoint& from, const QuantizedPoint& to, int axis,
                    int slab, Visit&& visit)
{
  const QuantizedPoint delta = to - from;
  // Twice the product of the extents, and one further edge, must fit 64 bits.
  constexpr std::int64_t max_short = std::int64_t(1) << 20;
  if ((delta.array().abs() < max_short).all())
    return detail::traverse<std::int64_t>(from, delta, axis, slab, visit);
  return detail::traverse<detail::Int128>(from, delta, axis, slab, visit);
}

/** \brief Visits exactly the voxels that the closed segment crosses, in order, by
 * integer arithmetic (Amanatides and Woo 1987 with rational times).
 *
 * Voxels are half open: a segment through an edge or a corner enters only the voxels
 * that contain one of its points.
 * \param[in] visit called with a VoxelIndex; returns false to stop
 * \return false if \a visit stopped it */
template <typename Visit>
bool
traverseSegment(const QuantizedPoint& from, const QuantizedPoint& to, Visit&& visit)
{
  return traverseSegmentFrom(from, to, 0, 0, visit);
}

} // namespace pcl_semantic
