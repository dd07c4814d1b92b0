// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The surface of voxels: faces between those that are occupied and the rest. */
struct VoxelMesh {
  /// A vertex: the lower corner of the voxel of this index is where it lies.
  std::vector<VoxelIndex> corners;
  /// A vertex: row of a voxel in the scene whose label and colour it has.
  std::vector<std::uint32_t> voxels;
  /// Squares, vertices counterclockwise as seen from outside.
  std::vector<std::array<std::uint32_t, 4>> faces;
};

/** \brief Makes the mesh. A vertex belongs to all faces there of one label and colour,
 * so that no colour bleeds into that of a neighbour.
 * \param[in] colours blue, green, red of each voxel
 * \throws InvalidParameterException if there are not as many colours as voxels, or more
 * than 2^31 - 1 vertices */
VoxelMesh blockyMesh(const VoxelScene& scene, const std::vector<cv::Vec3b>& colours);

/** \brief Writes the points of voxels as binary `.ply`: a vertex has x y z (float,
 * relative to VoxelScene::origin, which the header has as a comment) [m], red green
 * blue (uchar) and label (uint).
 * \param[in] colours blue, green, red of each voxel
 * \throws InvalidParameterException if there are not as many colours as voxels
 * \throws OutputException */
void writePlyPoints(const std::string& path, const VoxelScene& scene,
                    const std::vector<cv::Vec3b>& colours);

/** \brief Writes a mesh of the scene's voxels likewise; faces are squares
 * (vertex_indices).
 * \param[in] mesh that blockyMesh() has made of the same scene and colours */
void writePlyMesh(const std::string& path, const VoxelMesh& mesh,
                  const VoxelScene& scene, const std::vector<cv::Vec3b>& colours);

} // namespace pcl_semantic
