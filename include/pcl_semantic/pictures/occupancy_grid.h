// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Parameters of the conversion from a map to an occupancy grid. */
struct OccupancyGridParameters {
  std::vector<Label> ground; ///< classes of the ground
  double min_height = 0.3;   ///< of voxel centres above the local ground [m]
  double max_height = 2.0;   ///< of an obstacle [m]
  double reach = 5.0; ///< maximum distance to the nearest ground where a column has
                      ///< none [m]
};

/** \brief A 2D occupancy grid seen from above, one cell per column of voxels. */
struct OccupancyGrid {
  static constexpr std::uint8_t kOccupied = 0, kUnknown = 205, kFree = 254;

  cv::Mat cells;           ///< CV_8UC1 of these three values; x to the right, y upwards
  double resolution = 0.0; ///< edge of a cell [m]
  Eigen::Vector2d origin = Eigen::Vector2d::Zero(); ///< lower left corner, world [m]
};

/** \brief Computes the grid: a cell is occupied if it has an obstacle between the two
 * heights above ground.
 *
 * The ground of a column is the top of its lowest continuous run of ground voxels, or
 * that of the nearest column with ground within the reach; a median over 5 x 5 columns
 * smooths it. A cell is free if a voxel between the heights is free; if the scene has
 * no free voxels, a cell is free where its own ground was observed. Other cells are
 * unknown.
 * \throws InvalidParameterException if the heights or the reach are invalid
 * \throws BadInputException if there is no ground, or the grid is too large */
OccupancyGrid occupancyGrid(const VoxelScene& scene,
                            const OccupancyGridParameters& parameters);

/** \brief Path of the description of a grid's image: x.yaml for x.pgm. */
std::string gridDescription(const std::string& path);

/** \brief Writes an image `.pgm` and a description `.yaml` for ROS's map_server. The
 * description is written last: if it exists, the image exists.
 * \throws OutputException */
void writeOccupancyGrid(const std::string& path, const OccupancyGrid& grid);

} // namespace pcl_semantic
