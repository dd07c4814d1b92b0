// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/io/occupancy_grid.h>

namespace pcl_semantic {

/** \brief The columns of a scene seen from above, as an image: x to the right, y up. */
class VoxelColumns {
public:
  /** \throws BadInputException if they are too many for an image */
  explicit VoxelColumns(const VoxelScene& scene);

  cv::Size
  size() const
  {
    return {upper_.x() - lower_.x() + 1, upper_.y() - lower_.y() + 1};
  }

  /** \brief The pixel of a voxel's column; it may lie outside. */
  cv::Point
  pixelOf(const VoxelIndex& voxel) const
  {
    return {voxel.x() - lower_.x(), upper_.y() - voxel.y()};
  }

  bool
  contains(const VoxelIndex& voxel) const
  {
    return voxel.x() >= lower_.x() && voxel.x() <= upper_.x() &&
           voxel.y() >= lower_.y() && voxel.y() <= upper_.y();
  }

  /** \brief Index of the lowest voxel and column in each axis. */
  const VoxelIndex&
  lower() const
  {
    return lower_;
  }

private:
  VoxelIndex lower_, upper_;
};

/** \brief What a map stands on. */
struct LocalGround {
  cv::Mat height; ///< CV_32F: voxels below its upper side, from the lowest; NaN = none
  cv::Mat label;  ///< CV_8UC1: class of the column's own ground, 0 = none is seen
};

/** \brief Finds the ground of each column, see occupancyGrid().
 * \throws BadInputException if there is none at all */
LocalGround findGround(const VoxelScene& scene, const VoxelColumns& columns,
                       const OccupancyGridParameters& parameters);

} // namespace pcl_semantic
