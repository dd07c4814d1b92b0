// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/voxel_scene.h>
#include <pcl_semantic/pictures/voxel_colours.h>

#include <opencv2/core/mat.hpp>

#include <limits>
#include <set>
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
  LegendEntry entry;
};

/** \brief An image and its camera. */
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
    return centreOf(grid, indices[voxel]).z();
  }
};

/** \brief Prepares a map, in the colours of pcl_semantic_render.
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

/** \brief State of the view of a map; keys change it. */
struct ViewState {
  std::set<Label> hidden;
  std::size_t colouring = 0;                              ///< of the map's
  double below = std::numeric_limits<double>::infinity(); ///< ceiling [m]
  bool path = true, pictures = false, panel = true, help = false;
  int view = 0; ///< which of the views the camera takes next
  bool is_closed = false;

  /** \brief Whether a voxel is to be seen. */
  bool
  shows(const ViewedMap& map, std::size_t voxel) const
  {
    return map.heightOf(voxel) < below && hidden.count(map.labels[voxel]) == 0;
  }
};

/** \brief The part that has to be drawn again. */
enum class Redraw { nothing, panel, voxels, camera };

/** \brief Does what a key stands for.
 * \param[in] key as X names it: "m", "3", "Up"
 * \param[in] views how many there are */
Redraw press(const std::string& key, const ViewedMap& map, int views, ViewState& state);

/** \brief Shows a class if it is hidden, hides it if it is shown. */
void toggle(Label label, ViewState& state);

/** \brief The key of a class: its number, 0 for the tenth; none for those behind it. */
std::string keyOf(Label label);

/** \brief A line for each key: what it does. */
const std::vector<std::string>& helpOnKeys();

} // namespace pcl_semantic::tool
