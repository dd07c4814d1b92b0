// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/evaluation/label_reprojection.h>
#include <pcl_semantic/map/cube_renderer.h>

namespace pcl_semantic {

RenderedLabels
renderLabels(const VoxelCloud& voxels, const StereoCamera& camera,
             const Eigen::Isometry3d& T_world_camera, double max_depth)
{
  if (!voxels.cloud || voxels.cloud->size() != voxels.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "the voxels have " << voxels.size() << " indices, their cloud "
                                           << (voxels.cloud ? voxels.cloud->size() : 0)
                                           << " points");
  const CubeImage cubes =
      renderCubes(voxels.indices, voxels.voxel_size, camera, T_world_camera, max_depth);
  RenderedLabels result;
  result.labels = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
  cubes.depth.convertTo(result.depth, CV_32FC1);
  result.places = cubes.voxel;
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      const int voxel = cubes.voxel.at<int>(row, column);
      if (voxel >= 0)
        result.labels.at<std::uint8_t>(row, column) =
            static_cast<std::uint8_t>((*voxels.cloud)[std::size_t(voxel)].label);
    }
  return result;
}

} // namespace pcl_semantic
