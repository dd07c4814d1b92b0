// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fail.h"

#include <pcl/point_cloud.h>

#include <cstddef>

namespace pcl_semantic {

/** \brief Refuses a cloud whose width x height is not its number of points, as after
 * `cloud.points.push_back()`. Access by row and column would read out of bounds.
 * \throws InvalidParameterException */
inline void
requireCloudSize(std::size_t width, std::size_t height, std::size_t points)
{
  if (width * height != points)
    badParameter("the cloud has a width of ", width, " and a height of ", height,
                 ", but ", points, " points");
}

template <typename PointT>
void
requireCloudSize(const pcl::PointCloud<PointT>& cloud)
{
  requireCloudSize(cloud.width, cloud.height, cloud.size());
}

} // namespace pcl_semantic
