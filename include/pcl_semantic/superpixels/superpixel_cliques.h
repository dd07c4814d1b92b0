// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/superpixels/depth_jumps.h>
#include <pcl_semantic/superpixels/slic.h>

#include <Eigen/Geometry>

#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Parameters of SuperpixelCliques. */
struct SuperpixelParameters {
  SlicParameters slic;
  /// DepthJumps::passing_distance [m]. DepthJumps::near is two voxels.
  double passing_distance = 0.5;
  /// Voxels without a pixel in a frame keep their previous superpixel.
  bool keep = false;
  int min_voxels = 2; ///< cliques with fewer voxels are removed

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

/** \brief Superpixels of a frame as cliques of voxels. The frame must be integrated
 * into the map first.
 *
 * slicSuperpixels() clusters the colours of the frame. splitAtDepthJumps() splits the
 * superpixels into parts at depth discontinuities. The point of each pixel lies in a
 * voxel (as in SemanticVoxelMap::integrate()). A voxel joins the part with the most
 * pixels in it; in a tie, the part whose first pixel comes first in the image.
 *
 * Voxels without a pixel belong to no clique. With SuperpixelParameters::keep, such a
 * voxel keeps its previous group. Only groups of voxels in the last cloud are kept. */
class SuperpixelCliques : public CliqueGenerator {
public:
  SuperpixelCliques() = default;

  /** \throws InvalidParameterException as SuperpixelParameters::validate() */
  explicit SuperpixelCliques(const SuperpixelParameters& parameters);

  const SuperpixelParameters&
  parameters() const
  {
    return parameters_;
  }

  /** \brief Returns false, because the voxels need no colours: superpixels come from
   * the colours of the frame. */
  bool
  usesColour() const override
  {
    return false;
  }

  /** \brief Sets the frame of the next generate().
   * \param[in] cloud organized, camera frame [m]; not copied. Without a cloud (null),
   * generate() returns only kept superpixels
   * \param[in] T_world_camera pose of the camera
   * \throws BadInputException if the cloud has points and is not organized, or the pose
   * is not rigid */
  void setFrame(const Cloud::ConstPtr& cloud, const Eigen::Isometry3d& T_world_camera);

  /** \brief Sets the voxels of the points of the next generate(). Points of one voxel
   * join one superpixel.
   * \param[in] indices VoxelCloud::indices, one per point
   * \param[in] voxel_size [m]
   * \throws InvalidParameterException if the size is not positive */
  void setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size);

  /** \brief Groups the voxels.
   * \param[in] cloud as many points as in setVoxels(). Non-finite points belong to no
   * clique
   * \return cliques in the order of their first points
   * \throws InvalidParameterException if the numbers of points differ */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

private:
  void keepParts(std::vector<int>& parts);

  SuperpixelParameters parameters_;
  Cloud::ConstPtr frame_;
  Eigen::Isometry3d T_world_camera_ = Eigen::Isometry3d::Identity();
  std::vector<VoxelIndex> voxels_;
  double voxel_size_ = 0.0;
  std::vector<VoxelIndex> kept_voxels_; // of the last generate()
  std::vector<int> kept_parts_;
};

} // namespace pcl_semantic
