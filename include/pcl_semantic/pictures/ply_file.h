// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/io/voxel_scene.h>

#include <opencv2/core/mat.hpp>

#include <string>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes the points of voxels as binary `.ply`: a vertex has x y z (float,
 * relative to VoxelScene::origin, which is a comment in the header) [m], red green blue
 * (uchar) and label (uint).
 * \param[in] colours blue, green, red of each voxel
 * \throws InvalidParameterException unless there is one colour per voxel
 * \throws OutputException if the file cannot be written */
void writePlyPoints(const std::string& path, const VoxelScene& scene,
                    const std::vector<cv::Vec3b>& colours);

} // namespace pcl_semantic
