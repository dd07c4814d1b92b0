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
  /// Obstacles are voxels whose centres are at least min_height and less than
  /// max_height above the local ground [m].
  double min_height = 0.3;
  double max_height = 2.0;
  /// A column without ground uses the nearest ground up to this distance [m].
  double reach = 5.0;
};

/** \brief A 2D occupancy grid seen from above, one cell per column of voxels. */
struct OccupancyGrid {
  /// Values of the cells, as in ROS's map_server.
  static constexpr std::uint8_t kOccupied = 0, kUnknown = 205, kFree = 254;

  cv::Mat cells;           ///< CV_8UC1; world x to the right, world y upwards
  double resolution = 0.0; ///< edge of a cell [m]
  Eigen::Vector2d origin = Eigen::Vector2d::Zero(); ///< lower left corner, world [m]
};

/** \brief Computes an occupancy grid of a scene.
 *
 * The ground of a column is the top of its lowest continuous run of ground voxels. A
 * column without ground uses the ground of the nearest column within the reach. A
 * median over 5 x 5 columns smooths the ground.
 *
 * A cell is occupied if an occupied voxel lies between the two heights above the
 * ground. Otherwise it is free if a free voxel lies there. In a scene without free
 * voxels, a cell is free if its column has ground of its own, at most min_height above
 * or below the smoothed ground. All other cells are unknown.
 * \throws InvalidParameterException unless 0 <= min_height < max_height and the reach
 * is not negative
 * \throws BadInputException if the scene has no ground voxel or the grid is too large
 */
OccupancyGrid occupancyGrid(const VoxelScene& scene,
                            const OccupancyGridParameters& parameters);

/** \brief Path of the description that writeOccupancyGrid() writes: x.yaml for x.pgm.
 */
std::string gridDescription(const std::string& path);

/** \brief Writes an image and its description for ROS's map_server. The description is
 * written last, so a description never exists without its image.
 * \param[in] path of the image (.pgm)
 * \throws OutputException if a file cannot be written */
void writeOccupancyGrid(const std::string& path, const OccupancyGrid& grid);

} // namespace pcl_semantic
