// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <pcl/point_cloud.h>

#include <cmath>
#include <cstddef>
#include <limits>

/** \file Tests for missing measurements. Scanners mark a beam without a return by a
 * non-finite position, or by exactly 0 0 0 (drivers of Ouster, Livox and SICK). */

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

template <typename PointT>
bool
isAtZero(const PointT& point)
{
  return point.x == 0.0f && point.y == 0.0f && point.z == 0.0f;
}

/** \brief Whether a point of a scan, in the frame of its scanner, is a measurement. */
template <typename PointT>
bool
isReturn(const PointT& point)
{
  return std::isfinite(point.x) && std::isfinite(point.y) && std::isfinite(point.z) &&
         !isAtZero(point);
}

/** \brief Counts the points of a cloud, which may be a scan, at exactly 0 0 0 without a
 * measurement there. A single such point may be real and gives 0.
 * \param[in] count of the points
 * \param[in] isZero predicate for the index of a point */
template <typename IsZero>
std::size_t
countNoReturns(std::size_t count, IsZero&& isZero)
{
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < count; ++i)
    zeros += isZero(i) ? 1 : 0;
  return zeros > 1 ? zeros : 0;
}

/** \brief Does the same for a PCL cloud. */
template <typename PointT>
std::size_t
countNoReturns(const pcl::PointCloud<PointT>& cloud)
{
  return countNoReturns(cloud.size(),
                        [&](std::size_t i) { return isAtZero(cloud[i]); });
}

/** \brief Tells which points of any cloud have a position: finite, and not counted by
 * countNoReturns(). */
class PlaceTest {
public:
  template <typename PointT>
  explicit PlaceTest(const pcl::PointCloud<PointT>& cloud)
      : zero_is_none_(countNoReturns(cloud) > 0)
  {}

  template <typename PointT>
  bool
  operator()(const PointT& point) const
  {
    return isReturn(point) || (!zero_is_none_ && isAtZero(point));
  }

private:
  bool zero_is_none_;
};

/** \brief Moves the points at exactly 0 0 0 to NaN, which all algorithms ignore.
 * \return the number of moved points */
template <typename PointT>
std::size_t
eraseZeros(pcl::PointCloud<PointT>& cloud)
{
  std::size_t erased = 0;
  for (PointT& point : cloud)
    if (isAtZero(point)) {
      point.x = point.y = point.z = std::numeric_limits<float>::quiet_NaN();
      ++erased;
    }
  cloud.is_dense = cloud.is_dense && erased == 0;
  return erased;
}

} // namespace pcl_semantic
