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

/** \brief Pose of a camera, and the ground before it. */
struct GroundView {
  Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
  /// Camera frame [m], normal towards the camera; none if no ground was found.
  std::optional<Eigen::Hyperplane<double, 3>> ground;
};

/** \brief Evidence about cliques, one column or entry per clique, as input of a
 * LabelCalibration. */
struct CliqueEvidence {
  /// Geometric means of the members' measurements, each clamped at kMinProbability;
  /// zero for cliques without measurements.
  LabelDistributions distributions;
  /// Position features are computed at the members' mean, plus their lowest point and
  /// extent. Levelness is that of their best plane; unknown for fewer than three
  /// members or members on a line. All position features are unknown without a ground.
  /// The mean colour is always known.
  std::vector<PointFeatures> features;
};

/** \brief Computes evidence about cliques of voxels; the same for any number of
 * threads.
 * \param[in] cliques positions in \a voxels, none of them empty */
CliqueEvidence cliqueEvidence(const VoxelCloud& voxels,
                              const std::vector<pcl::PointIndices>& cliques,
                              const GroundView& view);

/** \brief Makes the cliques of a map's voxels according to a MapperConfig, and their
 * costs by a calibration. */
class MapCliques {
public:
  /** \brief A clique list, and psi_c(l) of eq. (7). */
  struct Result {
    std::vector<pcl::PointIndices> cliques;
    Eigen::MatrixXf costs; ///< L x C; empty without a calibration
  };

  /** \throws InvalidParameterException at invalid cliques, or an excluded class that is
   * not in the label set */
  MapCliques(const MapperConfig& config, const LabelSet& label_set);

  /** \brief Sets the calibration of cliques, learned by tryCalibration() from
   * cliqueSamples().
   * \throws InvalidParameterException unless it has the label set's classes */
  void setCalibration(LabelCalibration calibration);

  /** \brief Sets the ground classes; setCalibration() replaces them. */
  void
  setGround(std::vector<Label> ground)
  {
    ground_ = std::move(ground);
  }

  /** \brief Sets the frame of the next voxels.
   * \param[in] cloud organized, camera frame [m]; not copied
   * \param[in] network L x cloud.size(), to find the ground
   * \param[in] T_world_camera its pose */
  void setFrame(const pcl::PointCloud<pcl::PointXYZRGB>::ConstPtr& cloud,
                const LabelDistributions& network,
                const Eigen::Isometry3d& T_world_camera);

  /** \brief Groups voxels, except those of excluded classes. */
  std::vector<pcl::PointIndices> group(const VoxelCloud& voxels);

  /** \brief Computes evidence about cliques of these voxels in the last frame. */
  CliqueEvidence
  evidence(const VoxelCloud& voxels,
           const std::vector<pcl::PointIndices>& cliques) const
  {
    return cliqueEvidence(voxels, cliques, view_);
  }

  /** \brief Calls group(), and computes the costs -log p' of each clique's classes. */
  Result generate(const VoxelCloud& voxels);

private:
  CliqueGenerator::Ptr generator_;
  std::shared_ptr<SuperpixelCliques> superpixels_; // generator_, if of superpixels
  std::vector<Label> left_out_;
  std::optional<LabelCalibration> calibration_;
  std::vector<Label> ground_;
  int classes_;
  GroundView view_;
};

} // namespace pcl_semantic
