// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <pcl/point_cloud.h>

#include <cmath>
#include <cstddef>
#include <limits>

/** \file
 * What is no measurement. Scanners mark a beam that came back from nowhere by a
 * position that is not finite, or by exactly 0 0 0 (drivers of Ouster, Livox and SICK).
 */

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Whether a position is exactly 0 0 0. */
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

/** \brief The points of any cloud, which may be a scan, that are at exactly 0 0 0
 * without being measured there: none if there is one alone, which may be real.
 * \param[in] count of the points \param[in] isZero tells of each by its index */
template <typename IsZero>
std::size_t
countNoReturns(std::size_t count, IsZero&& isZero)
{
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < count; ++i)
    zeros += isZero(i) ? 1 : 0;
  return zeros > 1 ? zeros : 0;
}

/** \brief The same of a cloud of PCL's. */
template <typename PointT>
std::size_t
countNoReturns(const pcl::PointCloud<PointT>& cloud)
{
  return countNoReturns(cloud.size(),
                        [&](std::size_t i) { return isAtZero(cloud[i]); });
}

/** \brief Tells which points of any cloud are somewhere: at finite positions, without
 * those that countNoReturns() counts. */
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

/** \brief Moves the points at exactly 0 0 0 to NaN, which everything passes over.
 * \return how many */
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
