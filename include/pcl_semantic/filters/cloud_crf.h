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
  bool is_single = true;    ///< positions hold no more than single precision
  Eigen::Matrix3Xf colours; ///< red, green, blue, 0..255; empty = no colour
  std::vector<std::uint32_t> labels;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

/** \brief The CRF over the points of a cloud, whatever their type: settings, and run().
 */
class CloudCRF : public CRFSettings {
public:
  /** \brief The measurements: L x size of the input cloud; all-zero columns are
   * unlabelled and take the label of their neighbours, if one of these has any.
   * Replaces setLabelConfidence(). */
  void
  setLabelDistributions(const LabelDistributions& distributions)
  {
    measured_ = distributions;
    label_classes_ = 0;
  }

  /** \brief Takes the labels of the input cloud for measurements, 0 = unlabelled.
   * Replaces setLabelDistributions().
   * \param[in] confidence probability of the label, 0..1; the other classes share the
   * rest
   * \param[in] classes L, 1 to 255
   * \throws InvalidParameterException at another confidence or number of classes */
  void setLabelConfidence(double confidence, int classes);

  /** \brief The points are voxels: kernels take their positions from the indices, so
   * that the origin of the cloud changes nothing. \param[in] indices of all points of
   * the input cloud; empty = the points' own xyz \param[in] voxel_size [m] \throws
   * InvalidParameterException if the size is not positive */
  void setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size);

  /** \brief The origin that was subtracted from the input clouds' positions, as
   * LabelledCloud::origin is, beside what they take off doubles themselves: clique
   * generators lay their cells by it. Without a call, PCL_WARN says where single
   * precision has spoilt positions, see doubtOfSteps().
   * \param[in] origin [m]; zero by default
   * \throws InvalidParameterException unless finite */
  void setOrigin(const Eigen::Vector3d& origin);

  /** \brief Whether kernels look at the colours of the points, if their type has some.
   */
  void
  setUseColour(bool use)
  {
    use_colour_ = use;
  }

  /** \brief The cliques of the last two models, as indices of points; they may overlap
   * and leave points out. Points that take no part are left out of their cliques, and
   * cliques that lose all are skipped (CRFReport). Replaces a generator.
   * \throws InvalidParameterException that names the clique, if one is empty; an index
   * out of range is found in the run */
  void setCliques(const std::vector<pcl::PointIndices>& cliques);

  /** \brief Makes the cliques of each run from its input cloud, whose width and height
   * have to be set: all of its points, but for those that are passed over. Replaces
   * setCliques(); null = no cliques. */
  void
  setCliqueGenerator(const CliqueGenerator::Ptr& generator)
  {
    generator_ = generator;
    cliques_.reset();
  }

  /** \brief The refined distributions of the last filter(): L x size of the cloud. */
  const LabelDistributions&
  getLabelDistributions() const
  {
    return refined_;
  }

  /** \brief Points of the last filter() that were passed over: not finite, or more than
   * max_coordinate from the origin, which have label 0 and no distribution; and several
   * at exactly 0 0 0, the no-returns of a scanner, which keep theirs. */
  std::size_t
  getSkippedPoints() const
  {
    return skipped_points_;
  }

  /** \brief Beyond it [m] single precision has steps of a metre. */
  static constexpr float max_coordinate = 1e7f;

  /** \brief Refines the points of some indices.
   * \param[in,out] cloud the labels of these points are rewritten
   * \param[in] measured the cloud's own measurements, L x points, where none were set;
   * null = its labels, if setLabelConfidence() was called
   * \param[in] cliques the cloud's own, where neither cliques nor a generator were set
   * \throws InvalidParameterException, BadInputException as SemanticCRF */
  void run(CloudFields& cloud, const pcl::Indices& indices,
           const LabelDistributions* measured = nullptr,
           const std::vector<pcl::PointIndices>* cliques = nullptr);

  /** \brief run() of a cloud of no points, whatever was set for others. */
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

  /** \brief The labels that a field of any type holds, without instances; 0 for numbers
   * that are none, where labels are no measurements.
   * \param[in] is_single they were floats, which hold whole numbers up to 2^24
   * \throws BadInputException where they are measurements, naming the point */
  std::vector<std::uint32_t> labelsOf(const std::vector<double>& numbers,
                                      bool is_single) const;

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(); ///< see setOrigin()
  bool judges_steps_ = true;                         ///< likewise

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
