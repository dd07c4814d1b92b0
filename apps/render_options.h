// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_input.h"
#include "tool.h"

#include <pcl_semantic/pictures/scene_view.h>

#include <opencv2/core/types.hpp>

#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief View of a map, for an image or a window. */
struct RenderOptions {
  MapHints hints;
  std::string objects;           ///< file, "none", or empty: that of the map
  std::string planes;            ///< file; empty: none
  std::string view = "angle";    ///< angle, above, camera
  cv::Size size;                 ///< [px]
  bool looks_from = false;       ///< whether the next two are given
  Eigen::Vector3d from, look_at; ///< in the frame of the cloud's points [m]
  int frame = 0;                 ///< row of the trajectory

  /** \brief Unparsed options. */
  struct Texts {
    std::string from, look_at, size = "1600x900";
  } texts;
};

/** \brief Returns the options \a first, then --trajectory, --objects, --planes,
 * --from, --look-at, --label-set, --voxel-size, --view and --frame, then \a last. The
 * program adds --size. */
std::vector<Option> withRenderOptions(RenderOptions& options, std::vector<Option> first,
                                      const std::vector<Option>& last);

/** \brief Parses the texts.
 * \param[in] values the command line; options without effect are refused
 * \throws InvalidParameterException */
void readRenderOptions(const po::variables_map& values, RenderOptions& options);

/** \brief Refuses colours other than class, rgb and entropy.
 * \throws InvalidParameterException */
void requireColour(const std::string& colour);

/** \brief Options of earlier versions, see refuseRemoved(). */
extern const std::vector<std::pair<std::string, std::string>> removed_render_options;

/** \brief Returns the view of the options, in the frame of the scene's indices.
 * \param[in] poses result of posesInScene()
 * \throws InvalidParameterException if the pose or position does not exist */
SceneView viewOf(const RenderOptions& options, const VoxelScene& scene,
                 const Trajectory& poses);

/** \brief Path of the camera. */
SensorPath pathOf(const Trajectory& poses);

} // namespace pcl_semantic::tool
