// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "view_state.h"

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic::tool {

/** \brief A face of a cube that can be seen: its corners, counterclockwise as seen from
 * outside, and their colours. */
struct VoxelFace {
  std::array<std::array<float, 3>, 4> corners;        ///< as the cloud's points [m]
  std::array<std::array<std::uint8_t, 3>, 4> colours; ///< red, green, blue
};

/** \brief The faces between what is shown of a map and the rest, shaded as the pictures
 * of maps are: by their orientation and in the corners between voxels. A face that
 * looks up and lies open has the very colour of its voxel. */
std::vector<VoxelFace> facesOf(const ViewedMap& map, const ViewState& state);

} // namespace pcl_semantic::tool
