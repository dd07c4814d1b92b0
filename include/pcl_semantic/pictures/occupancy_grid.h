// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief How a map becomes a plan of the ground. */
struct OccupancyGridParameters {
  std::vector<Label> ground; ///< classes that the ground is made of
  double min_height = 0.3;   ///< above the local ground, of centres of voxels [m]
  double max_height = 2.0;   ///< what is higher is no obstacle [m]
  double reach = 5.0; ///< where there is no ground, how far the nearest may be [m]
};

/** \brief A plan of the ground, seen from above, a cell for each column of voxels. */
struct OccupancyGrid {
  static constexpr std::uint8_t kOccupied = 0, kUnknown = 205, kFree = 254;

  cv::Mat cells;           ///< CV_8UC1 of these three; x to the right, y upwards
  double resolution = 0.0; ///< side of a cell [m]
  Eigen::Vector2d origin = Eigen::Vector2d::Zero(); ///< lower left corner, world [m]
};

/** \brief Where an obstacle stands between the two heights above the ground.
 *
 * The ground of a column is the top of its lowest stretch of voxels of the ground's
 * classes; elsewhere that of the nearest column that has one, within the reach; then
 * the median of 5 x 5 columns. A column is free if a voxel between the heights is known
 * to be free; if the scene knows nothing of that, where its own ground is seen. Else it
 * is unknown.
 * \throws InvalidParameterException if the heights or the reach are none
 * \throws BadInputException if there is no ground, or the plan is too large */
OccupancyGrid occupancyGrid(const VoxelScene& scene,
                            const OccupancyGridParameters& parameters);

/** \brief The name of the description beside a grid's image: x.yaml for x.pgm. */
std::string gridDescription(const std::string& path);

/** \brief Writes an image `.pgm` and a description `.yaml` as ROS's map_server reads
 * them. The description appears last: where it is, the image is.
 * \throws OutputException */
void writeOccupancyGrid(const std::string& path, const OccupancyGrid& grid);

} // namespace pcl_semantic
