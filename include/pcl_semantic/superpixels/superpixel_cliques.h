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

struct SuperpixelParameters {
  SlicParameters slic;
  double passing_distance = 0.5; ///< of DepthJumps [m]; points within two voxels are
                                 ///< near
  bool keep = false;  ///< voxels out of view keep their superpixel from the last frame
                      ///< that saw them
  int min_voxels = 2; ///< smaller cliques are left out

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

/** \brief Superpixels of a frame, projected into the map after the frame was
 * integrated: a voxel joins the part of a superpixel with the most pixels in it.
 *
 * The frame's colours are clustered (slicSuperpixels()), its superpixels are split at
 * depth discontinuities (splitAtDepthJumps()), and each pixel with depth votes for its
 * part in the voxel of its point (SemanticVoxelMap::integrate()). In a tie, the part
 * whose first pixel comes first wins. Voxels without a pixel belong to no clique, or,
 * with SuperpixelParameters::keep, keep the groups of the last frame that saw them.
 * Only voxels of the last cloud are kept. */
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

  /** \brief The colours of the frame are used, not those of the voxels. */
  bool
  usesColour() const override
  {
    return false;
  }

  /** \brief Sets the frame of the next generate(); null = none, so that only kept
   * superpixels are returned.
   * \param[in] cloud organized, camera frame [m]; not copied
   * \param[in] T_world_camera its pose
   * \throws BadInputException if the cloud has points and is not organized, or the pose
   * is not finite */
  void setFrame(const Cloud::ConstPtr& cloud, const Eigen::Isometry3d& T_world_camera);

  /** \brief Sets the voxels of the points of the next generate(), as in VoxelCloud;
   * points of one voxel join one superpixel.
   * \param[in] indices global, one per point
   * \param[in] voxel_size [m]
   * \throws InvalidParameterException if the size is not positive */
  void setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size);

  /** \brief Groups the voxels; in the order of their first points.
   * \param[in] cloud as many points as in setVoxels(); non-finite points belong to no
   * clique
   * \throws InvalidParameterException if the numbers differ */
  std::vector<pcl::PointIndices> generate(const Cloud& cloud) override;

private:
  void keepParts(std::vector<int>& parts);

  SuperpixelParameters parameters_;
  Cloud::ConstPtr frame_;
  Eigen::Isometry3d T_world_camera_ = Eigen::Isometry3d::Identity();
  std::vector<VoxelIndex> voxels_;
  double voxel_size_ = 0.0;
  std::vector<VoxelIndex> kept_voxels_; // of the last call
  std::vector<int> kept_parts_;
};

} // namespace pcl_semantic
