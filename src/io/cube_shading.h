// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/io/picture_view.h>
#include <pcl_semantic/map/cube_renderer.h>

#include <opencv2/core/mat.hpp>

namespace pcl_semantic {

/** \brief How bright each pixel of a rendering is: faces by orientation, darker in the
 * corners between voxels and behind the edges of nearer ones.
 * \return CV_32FC1, about 0.3 to 1; 1 where there is no voxel */
cv::Mat shadeCubes(const VoxelScene& scene, const CubeImage& cubes,
                   const PictureView& view);

} // namespace pcl_semantic
