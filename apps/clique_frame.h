// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/superpixel_cliques.h>

#include <string>

namespace pcl_semantic::tool {

/** \brief The frame whose superpixels a map gets. */
struct CliqueFrame {
  std::string path;        ///< organized cloud, camera frame
  std::string pose;        ///< see poseOf(); empty = the VIEWPOINT of the cloud
  std::string calibration; ///< calib.txt, if the pose is of camera 0; may be empty
  Eigen::Vector3d map_origin = Eigen::Vector3d::Zero(); ///< of the map's points [m]
  double voxel_size = 0.1;                              ///< of the map [m]
};

/** \brief A pose from text: "x y z qx qy qz qw", the camera in the world, or FILE:N,
 * row N of a KITTI trajectory (camera 0), as a map's trajectory.txt is one. \param[in]
 * calibration KITTI's calib.txt: then the camera is its left colour (or grey) one;
 * empty: camera 0 \throws InvalidParameterException or, of FILE, BadInputException if
 * it is none of these */
Eigen::Isometry3d poseOf(const std::string& text, const std::string& calibration);

/** \brief Tells a generator of the frame and the voxels of a map.
 * \param[in] name of the map, for messages
 * \param[in] points of the map [m], one in the middle of each voxel, or any
 * \throws BadInputException at a frame or a point that cannot be */
void setFrame(const CliqueFrame& frame, const std::string& name,
              const CliqueGenerator::Cloud& points, SuperpixelCliques& generator);

} // namespace pcl_semantic::tool
