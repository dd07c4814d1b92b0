// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/voxel_colours.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief One way to paint a map. */
struct Colouring {
  std::string name; ///< as --colour has it
  VoxelColours colours;
};

/** \brief A class that a map has, as its legend shows it. */
struct ViewedClass {
  Label label = kUnlabelled;
  std::string name;
  cv::Vec3b colour; ///< blue, green, red: that of the label set
  std::size_t voxels = 0;
};

/** \brief What a camera saw, and from where. */
struct ViewedImage {
  cv::Mat image;       ///< CV_8UC3 (BGR)
  StereoCamera camera; ///< of the image
  Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
};

/** \brief All that a window shows of a map, painted and ready to be drawn. Positions
 * are those of the cloud's points [m]. */
struct ViewedMap {
  std::string title;
  VoxelGrid grid;
  std::vector<VoxelIndex> indices;
  std::vector<Label> labels; ///< of each voxel
  std::vector<ViewedClass> classes;
  std::vector<Colouring> colourings; ///< those that the map can be painted with
  Trajectory path;                   ///< of the camera
  std::vector<ViewedImage> pictures;

  /** \brief Height of a voxel's centre [m]. */
  double
  heightOf(std::size_t voxel) const
  {
    return grid.corner.z() + (indices[voxel].z() + 0.5) * grid.size;
  }
};

/** \brief Prepares a map. Classes have the colours of the label set, the very ones of
 * map_classes.pcd, overlays and top views.
 * \throws BadInputException if it has neither labels nor colours
 * \throws InvalidParameterException at a label beyond the label set */
ViewedMap viewedMap(const VoxelScene& scene, const LabelSet& label_set,
                    const std::string& title);

/** \brief Index of a colouring in the map.
 * \throws InvalidParameterException if the map cannot be painted so */
std::size_t colouringOf(const ViewedMap& map, const std::string& name);

/** \brief Some pictures of a KITTI sequence, evenly along the path and the
 * last among them, small.
 * \param[in] T_map_camera0 row n belongs to frame n
 * \param[in] most how many
 * \throws BadInputException if it cannot be read or no frame has a pose */
std::vector<ViewedImage> imagesOf(const std::string& sequence,
                                  const Trajectory& T_map_camera0, std::size_t most);

} // namespace pcl_semantic::tool
