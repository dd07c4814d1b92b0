// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/stereo_camera.h>
#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/voxel_scene.h>
#include <pcl_semantic/pictures/scene_lines.h>
#include <pcl_semantic/pictures/voxel_colours.h>
#include <pcl_semantic/things/object_summary.h>

#include <opencv2/core/mat.hpp>

#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief Colours of a map. */
struct Colouring {
  std::string name; ///< as in --colour
  VoxelColours colours;
};

/** \brief A class of a map, for its legend. */
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

/** \brief An object of a map. */
struct ViewedObject {
  std::string text; ///< number, class and motion
  Label label = kUnlabelled;
  cv::Vec3b colour; ///< blue, green, red
  YawBox box;       ///< around its voxels
};

/** \brief The content of a window on a map, ready for drawing. Positions are in the
 * frame of the cloud's points [m]. */
struct ViewedMap {
  std::string title;
  VoxelGrid grid;
  std::vector<VoxelIndex> indices;
  std::vector<Label> labels; ///< per voxel
  std::vector<ViewedClass> classes;
  std::vector<Colouring> colourings; ///< available ones
  Trajectory path;                   ///< of the camera
  std::vector<ViewedImage> pictures;
  std::vector<ViewedObject> objects;
  std::vector<SceneLine> outlines; ///< of planes

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

/** \brief Prepares the objects of a map.
 * \param[in] objects in the world frame
 * \param[in] origin of the cloud's points [m] */
std::vector<ViewedObject> viewedObjects(const std::vector<ObjectSummary>& objects,
                                        const LabelSet& label_set, double voxel_size,
                                        const Eigen::Vector3d& origin);

/** \brief Index of a colouring in the map.
 * \throws InvalidParameterException if the map does not have it */
std::size_t colouringOf(const ViewedMap& map, const std::string& name);

/** \brief Reads some small images of a KITTI sequence, evenly distributed along the
 * path, including the last one.
 * \param[in] T_map_camera0 row n belongs to frame n
 * \param[in] most maximum number
 * \throws BadInputException if an image cannot be read or no frame has a pose */
std::vector<ViewedImage> imagesOf(const std::string& sequence,
                                  const Trajectory& T_map_camera0, std::size_t most);

/** \brief State of the view of a map; keys change it. */
struct ViewState {
  std::set<Label> hidden;
  std::size_t colouring = 0;                              ///< index of the map's
  double below = std::numeric_limits<double>::infinity(); ///< ceiling [m]
  bool path = true, pictures = false, panel = true, help = false, boxes = true;
  std::optional<std::size_t> selected; ///< index of the object that the panel describes
  int view = 0;                        ///< index of the next view of the camera
  bool is_closed = false;

  /** \brief Whether a voxel is visible. */
  bool
  shows(const ViewedMap& map, std::size_t voxel) const
  {
    return map.heightOf(voxel) < below && hidden.count(map.labels[voxel]) == 0;
  }

  /** \brief Whether the box of an object is visible. */
  bool
  shows(const ViewedObject& object) const
  {
    return boxes && hidden.count(object.label) == 0;
  }
};

/** \brief The part to redraw. */
enum class Redraw { nothing, panel, voxels, camera };

/** \brief Handles a key.
 * \param[in] key X's name of it: "m", "3", "Up"
 * \param[in] views number of views */
Redraw press(const std::string& key, const ViewedMap& map, int views, ViewState& state);

/** \brief Shows a class if it is hidden, hides it if it is shown. */
void toggle(Label label, ViewState& state);

/** \brief The object whose visible box a ray enters first; none if it misses all.
 * \param[in] from,to two points of the ray [m] */
std::optional<std::size_t> objectAt(const ViewedMap& map, const ViewState& state,
                                    const Eigen::Vector3d& from,
                                    const Eigen::Vector3d& to);

/** \brief The key of a class: its number, 0 for the tenth; none for later classes. */
std::string keyOf(Label label);

/** \brief Help on the keys, one line per key. */
const std::vector<std::string>& helpOnKeys();

} // namespace pcl_semantic::tool
