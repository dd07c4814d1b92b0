// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_input.h"
#include "tool.h"

#include <pcl_semantic/pictures/scene_view.h>

#include <opencv2/core/types.hpp>

#include <string>
#include <vector>

namespace pcl_semantic::tool {

/** \brief From where a map is seen, as a picture or in a window. */
struct RenderOptions {
  MapHints hints;
  std::string view = "angle";    ///< angle, above, camera
  cv::Size size;                 ///< [px]
  bool looks_from = false;       ///< whether the next two are given
  Eigen::Vector3d from, look_at; ///< as the cloud's points [m]
  int frame = 0;                 ///< row of the trajectory

  /** \brief Options as they are typed. */
  struct Texts {
    std::string from, look_at, size = "1600x900";
  } texts;
};

/** \brief The options \a first, then --trajectory, --from, --look-at, --label-set,
 * --voxel-size, --view and --frame, then \a last; --size is the program's own. */
std::vector<Option> withRenderOptions(RenderOptions& options, std::vector<Option> first,
                                      const std::vector<Option>& last);

/** \brief Reads what was typed. \param[in] values the command line: what has no effect
 * with the rest is refused \throws InvalidParameterException */
void readRenderOptions(const po::variables_map& values, RenderOptions& options);

/** \brief Refuses what is not class, rgb or entropy.
 * \throws InvalidParameterException */
void requireColour(const std::string& colour);

/** \brief Options of earlier versions, see refuseRemoved(). */
extern const std::vector<std::pair<std::string, std::string>> removed_render_options;

/** \brief The view that the options ask for, in the frame of the scene's indices.
 * \param[in] poses as posesInScene() has them
 * \throws InvalidParameterException if there is no such pose or position */
SceneView viewOf(const RenderOptions& options, const VoxelScene& scene,
                 const Trajectory& poses);

/** \brief Where the camera was. */
SensorPath pathOf(const Trajectory& poses);

} // namespace pcl_semantic::tool
