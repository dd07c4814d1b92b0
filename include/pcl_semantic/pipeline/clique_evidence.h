// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/point_features.h>
#include <pcl_semantic/core/voxel_cloud.h>

#include <Eigen/Geometry>
#include <pcl/PointIndices.h>

#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Where a camera was, and the ground before it. */
struct GroundView {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  /// Camera frame [m], normal towards the camera; nothing: no ground was found.
  std::optional<Eigen::Hyperplane<double, 3>> ground;
};

/** \brief What is known of cliques, a column or an entry each, in the form that a
 * LabelCalibration takes. */
struct CliqueEvidence {
  /// Geometric means of the members' measurements, each clamped at kLeastProbability;
  /// zero for cliques whose members have none.
  LabelDistributions distributions;
  /// Of the members' mean place, height, distance and side; levelness of their best
  /// plane, not known of fewer than three or of those in a line; lowest and extent; all
  /// unknown without a ground. The mean colour is always known.
  std::vector<PointFeatures> features;
};

/** \brief Looks at cliques of voxels; the same for any number of threads.
 * \param[in] cliques places in \a voxels, none of them empty */
CliqueEvidence cliqueEvidence(const VoxelCloud& voxels,
                              const std::vector<pcl::PointIndices>& cliques,
                              const GroundView& view);

} // namespace pcl_semantic
