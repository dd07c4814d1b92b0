// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/filters/label_refiner.h>

#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The part of SemanticCRF that does not know the type of the points. */
class CloudRefiner : public LabelRefiner {
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

  /** \brief As LabelRefiner::setCliques(); replaces a generator. */
  void
  setCliques(const std::vector<pcl::PointIndices>& cliques)
  {
    LabelRefiner::setCliques(cliques);
    generator_.reset();
  }

  /** \brief Makes the cliques of each run from its input cloud, whose width and height
   * have to be set: all of its points, but for those that are passed over. Replaces
   * setCliques(); null = no cliques. */
  void
  setCliqueGenerator(const CliqueGenerator::Ptr& generator)
  {
    generator_ = generator;
    has_cliques_ = false;
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

protected:
  /** \brief The fields of all points of a cloud. */
  struct Fields {
    Eigen::Matrix3Xf positions;                       ///< relative to `origin` [m]
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< [m]
    bool is_single = true;    ///< positions hold no more than single precision
    Eigen::Matrix3Xf colours; ///< red, green, blue, 0..255; empty = no colour
    std::vector<std::uint32_t> labels;
    std::uint32_t width = 0;
    std::uint32_t height = 0;
  };

  ~CloudRefiner() = default;

  bool
  hasMeasurements() const
  {
    return label_classes_ > 0 || !measured_.empty();
  }

  bool
  hasCliqueSource() const
  {
    return has_cliques_ || generator_;
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

  /** \brief Refines the points of some indices.
   * \param[in,out] fields the labels of these points are rewritten
   * \throws InvalidParameterException, BadInputException as SemanticCRF */
  void refineCloud(Fields& fields, const pcl::Indices& indices);

  /** \brief The result of a cloud of no points, whatever was set for others. */
  void refineNothing();

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(); ///< see setOrigin()
  bool judges_steps_ = true;                         ///< likewise

private:
  LabelDistributions measurements(const Fields& fields,
                                  const pcl::Indices& indices) const;

  Elements elementsOf(const Fields& fields, const pcl::Indices& indices) const;

  void makeCliques(const Fields& fields);

  LabelDistributions measured_;
  double label_confidence_ = 0.0;
  int label_classes_ = 0; // 0 = distributions were set
  std::vector<VoxelIndex> voxels_;
  double voxel_size_ = 0.0;
  CliqueGenerator::Ptr generator_;
  bool use_colour_ = true;
  LabelDistributions refined_;
  std::size_t skipped_points_ = 0;
};

} // namespace pcl_semantic
