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
  bool keep = false;  ///< voxels out of view stay with the superpixel of the last frame
                      ///< that saw them
  int min_voxels = 2; ///< cliques of fewer are left out

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;
};

/** \brief Superpixels of a frame, projected into the map that the frame went into: a
 * voxel joins the part of a superpixel that most of its pixels see.
 *
 * The frame's colours are clustered (slicSuperpixels), its superpixels split where they
 * jump in depth (splitAtDepthJumps), and each pixel with depth votes for its part in
 * the voxel that SemanticVoxelMap::integrate puts its point in; of equal numbers the
 * part whose first pixel comes first wins. Voxels that no pixel falls in are in no
 * clique, or, with SuperpixelParameters::keep, stay together as they were in the last
 * frame that saw them; what is kept are the voxels of the last cloud alone. */
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

  /** \brief Of the frame, not of the voxels. */
  bool
  usesColour() const override
  {
    return false;
  }

  /** \brief The frame of the next generate(); null = none, so that only kept
   * superpixels are given.
   * \param[in] cloud organized, camera frame [m]; not copied
   * \param[in] T_world_camera its pose
   * \throws BadInputException if the cloud has points and is not organized, or the pose
   * is not finite */
  void setFrame(const Cloud::ConstPtr& cloud, const Eigen::Isometry3d& T_world_camera);

  /** \brief The voxels of the points of the next generate(), as VoxelCloud has them;
   * points of one voxel join one superpixel.
   * \param[in] indices global, one a point
   * \param[in] voxel_size [m]
   * \throws InvalidParameterException if the size is not positive */
  void setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size);

  /** \brief Groups the voxels; in the order of their first points.
   * \param[in] cloud as many points as setVoxels() had; those that are not finite are
   * in no clique
   * \throws InvalidParameterException if they are another number */
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
