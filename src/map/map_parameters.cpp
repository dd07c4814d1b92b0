// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/map/map_parameters.h>

#include "core/fail.h"
#include "directed_ray.h"

#include <algorithm>

namespace pcl_semantic {

MapParameters
MapParameters::withWindow() const
{
  MapParameters parameters = *this;
  if (window.isZero(0.0)) {
    const double extent = std::min(2.0 * max_range + 4.0, 204.0);
    parameters.window = {extent, extent, std::min(extent, 24.0)};
  }
  return parameters;
}

void
MapParameters::validate() const
{
  if (!(voxel_size >= 1e-3 && voxel_size <= 100.0))
    badParameter("voxel_size is ", voxel_size, " m, expected 0.001 to 100");
  if (!window.isZero(0.0) &&
      !((window.array() >= voxel_size).all() && (window.array() <= 1e5).all()))
    badParameter("window is ", window.transpose(),
                 " m, expected at least a voxel and at most 1e5");
  if (!(max_range > 0.0 && max_range <= 1e4))
    badParameter("max_depth is ", max_range, " m, expected more than 0, at most 1e4");
  if (max_range > kMaxRayVoxels * voxel_size)
    badParameter("max_depth is ", max_range, " m, with voxels of ", voxel_size,
                 " m expected at most ", kMaxRayVoxels * voxel_size);
  fusion.validate();
}

} // namespace pcl_semantic
