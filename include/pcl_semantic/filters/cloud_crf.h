// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/filters/crf_settings.h>

#include <Eigen/Core>
#include <pcl/PointIndices.h>
#include <pcl/types.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The fields of all points of a cloud. */
struct CloudFields {
  Eigen::Matrix3Xf positions;                       ///< relative to `origin` [m]
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< [m]
  bool is_single = true;    ///< positions fit in single precision
  Eigen::Matrix3Xf colours; ///< red, green, blue, 0..255; empty = no colour
  std::vector<std::uint32_t> labels;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

/** \brief A CRF over the points of a cloud of any type: settings and run(). */
class CloudCRF : public CRFSettings {
public:
  /** \brief Sets the measurements, L x size of the input cloud. All-zero columns are
   * unlabelled and take the label of their neighbours, if any have one. Replaces
   * setLabelConfidence(). */
  void
  setLabelDistributions(const LabelDistributions& distributions)
  {
    measured_ = distributions;
    label_classes_ = 0;
  }

  /** \brief Uses the labels of the input cloud as measurements, 0 = unlabelled.
   * Replaces setLabelDistributions().
   * \param[in] confidence probability of the label, 0..1; the other classes share the
   * rest
   * \param[in] classes L, 1 to 255
   * \throws InvalidParameterException if \a confidence or \a classes is out of range */
  void setLabelConfidence(double confidence, int classes);

  /** \brief Treats the points as voxels: kernels take positions from the indices, so
   * the origin of the cloud has no effect.
   * \param[in] indices one per point of the input cloud; empty = use the points' xyz
   * \param[in] voxel_size [m]
   * \throws InvalidParameterException if the size is not positive */
  void setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size);

  /** \brief Sets the origin that was subtracted from the input positions, as in
   * LabelledCloud::origin. Clique generators align their cells with it. Without this
   * call, PCL_WARN reports positions degraded by single precision, see doubtOfSteps().
   * \param[in] origin [m]; zero by default
   * \throws InvalidParameterException unless finite */
  void setOrigin(const Eigen::Vector3d& origin);

  /** \brief Whether kernels use the colours of the points, if the type has colours. */
  void
  setUseColour(bool use)
  {
    use_colour_ = use;
  }

  /** \brief Sets the cliques of the last two models, as indices of points. Cliques may
   * overlap and need not cover all points. Points that take no part are removed from
   * their cliques, and cliques without remaining members are skipped (CRFReport).
   * Replaces a generator.
   * \throws InvalidParameterException that names the clique, if one is empty; run()
   * reports an index out of range */
  void setCliques(const std::vector<pcl::PointIndices>& cliques);

  /** \brief Makes the cliques of each run from all valid points of its input cloud,
   * whose width and height must be set. Replaces setCliques(); null = no cliques. */
  void
  setCliqueGenerator(const CliqueGenerator::Ptr& generator)
  {
    generator_ = generator;
    cliques_.reset();
  }

  /** \brief Refined distributions of the last filter(): L x size of the cloud. */
  const LabelDistributions&
  getLabelDistributions() const
  {
    return refined_;
  }

  /** \brief Number of points skipped by the last filter(). Points that are not finite
   * or more than max_coordinate from the origin get label 0 and no distribution. Two or
   * more points at exactly 0 0 0 (no-returns of a scanner) keep their label and
   * distribution. */
  std::size_t
  getSkippedPoints() const
  {
    return skipped_points_;
  }

  /** \brief Largest coordinate [m]; beyond it single precision has steps of a metre. */
  static constexpr float max_coordinate = 1e7f;

  /** \brief Refines the points of the given indices.
   * \param[in,out] cloud the labels of these points are rewritten
   * \param[in] measured the cloud's own measurements, L x points, used if none were
   * set; null = its labels, if setLabelConfidence() was called
   * \param[in] cliques the cloud's own, used if neither cliques nor a generator were
   * set
   * \throws InvalidParameterException, BadInputException as SemanticCRF */
  void run(CloudFields& cloud, const pcl::Indices& indices,
           const LabelDistributions* measured = nullptr,
           const std::vector<pcl::PointIndices>* cliques = nullptr);

  /** \brief run() for a cloud without points; ignores settings that depend on the
   * size. */
  void runEmpty();

protected:
  ~CloudCRF() = default;

  bool
  hasMeasurements() const
  {
    return label_classes_ > 0 || !measured_.empty();
  }

  bool
  hasCliqueSource() const
  {
    return cliques_ || generator_;
  }

  bool
  usesColour() const
  {
    return use_colour_;
  }

  /** \brief Converts numbers of any type to labels without instances; 0 for an invalid
   * number where labels are not measurements.
   * \param[in] is_single the numbers were floats, which are exact up to 2^24
   * \throws BadInputException that names the point, if labels are measurements */
  std::vector<std::uint32_t> labelsOf(const std::vector<double>& numbers,
                                      bool is_single) const;

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(); ///< see setOrigin()
  bool judges_steps_ = true;                         ///< false once an origin was set

private:
  LabelDistributions measurements(const CloudFields& cloud, const pcl::Indices& indices,
                                  const LabelDistributions* own) const;

  std::vector<pcl::PointIndices> makeCliques(const CloudFields& cloud) const;

  LabelDistributions measured_;
  double label_confidence_ = 0.0;
  int label_classes_ = 0; // 0 = distributions were set
  std::vector<VoxelIndex> voxels_;
  double voxel_size_ = 0.0;
  std::optional<std::vector<pcl::PointIndices>> cliques_;
  CliqueGenerator::Ptr generator_;
  bool use_colour_ = true;
  LabelDistributions refined_;
  std::size_t skipped_points_ = 0;
};

} // namespace pcl_semantic
