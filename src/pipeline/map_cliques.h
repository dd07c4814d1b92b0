// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/core/point_features.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/labelling/label_calibration.h>
#include <pcl_semantic/pipeline/mapper_config.h>
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include <Eigen/Geometry>
#include <pcl/PointIndices.h>

#include <memory>
#include <optional>
#include <vector>

namespace pcl_semantic {

/** \brief Where a camera was, and the ground before it. */
struct GroundView {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  /// Camera frame [m], normal towards the camera; nothing: no ground was found.
  std::optional<Eigen::Hyperplane<double, 3>> ground;
};

/** \brief Evidence about cliques, a column or an entry each, in the form that a
 * LabelCalibration takes. */
struct CliqueEvidence {
  /// Geometric means of the members' measurements, each clamped at kMinProbability;
  /// zero for cliques whose members have none.
  LabelDistributions distributions;
  /// Of the members' mean position, height, distance and side; levelness of their best
  /// plane, not known of fewer than three or of those in a line; lowest and extent; all
  /// unknown without a ground. The mean colour is always known.
  std::vector<PointFeatures> features;
};

/** \brief Looks at cliques of voxels; the same for any number of threads.
 * \param[in] cliques positions in \a voxels, none of them empty */
CliqueEvidence cliqueEvidence(const VoxelCloud& voxels,
                              const std::vector<pcl::PointIndices>& cliques,
                              const GroundView& view);

/** \brief The cliques of a map's voxels as a MapperConfig has them, and what a
 * calibration says of each. */
class MapCliques {
public:
  /** \brief A clique list, and psi_c(l) of eq. (7). */
  struct Result {
    std::vector<pcl::PointIndices> cliques;
    Eigen::MatrixXf costs; ///< L x C; empty without a calibration
  };

  /** \throws InvalidParameterException at cliques that cannot be, or a class to leave
   * out that is not in the label set */
  MapCliques(const MapperConfig& config, const LabelSet& label_set);

  /** \brief Sets the calibration of cliques, as tryCalibration() learns it from
   * cliqueSamples(). \throws InvalidParameterException if it is not one of the label
   * set's classes */
  void setCalibration(LabelCalibration calibration);

  /** \brief The classes that the ground is made of; setCalibration() brings its own. */
  void
  setGround(std::vector<Label> ground)
  {
    ground_ = std::move(ground);
  }

  /** \brief The frame that the next voxels are seen in.
   * \param[in] cloud organized, camera frame [m]; not copied
   * \param[in] network L x cloud.size(), finds the ground
   * \param[in] T_world_camera its pose */
  void setFrame(const pcl::PointCloud<pcl::PointXYZRGB>::ConstPtr& cloud,
                const LabelDistributions& network,
                const Eigen::Isometry3d& T_world_camera);

  /** \brief Groups voxels, less those of classes to leave out. */
  std::vector<pcl::PointIndices> group(const VoxelCloud& voxels);

  /** \brief Evidence about cliques of these voxels in the last frame. */
  CliqueEvidence
  evidence(const VoxelCloud& voxels,
           const std::vector<pcl::PointIndices>& cliques) const
  {
    return cliqueEvidence(voxels, cliques, view_);
  }

  /** \brief group(), and the costs -log p' of each clique's classes. */
  Result generate(const VoxelCloud& voxels);

private:
  CliqueGenerator::Ptr generator_;
  std::shared_ptr<SuperpixelCliques> superpixels_; // generator_, if it is some
  std::vector<Label> left_out_;
  std::optional<LabelCalibration> calibration_;
  std::vector<Label> ground_;
  int classes_;
  GroundView view_;
};

} // namespace pcl_semantic
