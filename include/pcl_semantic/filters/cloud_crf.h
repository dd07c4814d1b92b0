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
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

struct CRFElements;

/** \brief The fields of a cloud that a CRF reads: one column or entry per point. */
struct CloudFields {
  Eigen::Matrix3Xf positions;  ///< relative to `origin` [m]
  Eigen::Matrix3Xf remainders; ///< of positions, remaindersOf() [m]; empty = none
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< frame of the cloud [m]
  bool is_single = true;    ///< the cloud's own positions have single precision
  Eigen::Matrix3Xf colours; ///< red, green, blue, 0..255; empty = no colour
  std::vector<std::uint32_t> labels; ///< 0 = unlabelled
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

/** \brief A random sample of a cloud larger than memory, with figures of all of it. */
struct CloudSample {
  std::size_t points = 0;     ///< of the cloud
  std::size_t unlabelled = 0; ///< points of the cloud without a measurement
  double spacing = 0.0;       ///< CRFReport::spacing
  Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< [m]
  Eigen::Matrix3Xf positions; ///< of the sample, relative to `origin`, finite [m]
  bool has_colour = false;    ///< of the points
  Eigen::Vector3f low;        ///< least coordinates of the cloud, as `positions` [m]
  Eigen::Vector3f colour_low; ///< least colours of the cloud
};

/** \brief A CRF over the points of a cloud of any type: settings and run(). */
class CloudCRF : public CRFSettings {
public:
  /** \brief Sets the measurements. Replaces setLabelConfidence().
   * \param[in] distributions L x size of the input cloud. The points of all-zero
   * columns are unlabelled. They take the label of their neighbours, if a neighbour has
   * one */
  void
  setLabelDistributions(const LabelDistributions& distributions)
  {
    measured_ = distributions;
    is_measured_once_ = false;
    label_classes_ = 0;
  }

  /** \brief Does the same as setLabelDistributions() without a copy, for the next run
   * only. */
  void
  giveLabelDistributions(LabelDistributions&& distributions)
  {
    measured_ = std::move(distributions);
    is_measured_once_ = true;
    label_classes_ = 0;
  }

  /** \brief Uses the labels of the input cloud as measurements, 0 = unlabelled.
   * Replaces setLabelDistributions().
   * \param[in] confidence probability of the label, 0..1. The other classes share the
   * remaining probability equally
   * \param[in] classes L, 1 to 255
   * \throws InvalidParameterException if \a confidence or \a classes is out of range */
  void setLabelConfidence(double confidence, int classes);

  /** \brief Treats the points as voxels: kernels compute the positions from voxel
   * indices instead of xyz. The result then does not depend on the origin of the cloud.
   * \param[in] indices one per point of the input cloud; empty = use xyz
   * \param[in] voxel_size [m]
   * \throws InvalidParameterException if there are indices and the size is not positive
   */
  void setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size);

  /** \brief Sets the origin of the input positions: the point that was subtracted from
   * them, as LabelledCloud::origin. Clique generators align their cells with this
   * origin.
   *
   * Without this call, a cloud whose positions have lost precision far from 0 is
   * reported by PCL_WARN, see doubtOfSteps().
   * \param[in] origin [m]; zero by default
   * \throws InvalidParameterException unless finite */
  void setOrigin(const Eigen::Vector3d& origin);

  /** \brief Sets the remainders of the positions of the next input cloud, which single
   * precision does not hold. A cloud many kilometres wide is then refined in tiles of
   * up to a kilometre, with their precision. Models with cliques or own kernels, and
   * voxels, ignore them.
   * \param[in] remainders remaindersOf(), 3 x points [m]; empty = none (the default).
   * filter() fails if their number differs from that of the points
   * \throws InvalidParameterException unless finite */
  void setRemainders(Eigen::Matrix3Xf remainders);

  /** \brief Sets whether kernels and clique generators use the colours of the points;
   * true by default. The setting has no effect if the point type has no colours. */
  void
  setUseColour(bool use)
  {
    use_colour_ = use;
  }

  /** \brief Sets the number of points that are refined at once, 250000 by default.
   *
   * A larger cloud is refined in tiles of at most as many points and their
   * surroundings, so that the memory of the model grows little with the cloud. Nearly
   * all labels are those of a run in one piece (doc/crf.md, "Large clouds"). A tile is
   * not divided further if its parts would need most of it. Models with cliques or own
   * kernels (addKernel()), and voxels (setVoxels()), are refined in one piece.
   *
   * \throws InvalidParameterException if it is 0 */
  void setTileSize(std::size_t points);

  /** \brief Makes the next runs refine parts of a larger cloud, whose spacing, kernels
   * and use of colour they take. Model, parameters and setUseColour() are set before.
   * A part is refined in one piece. setClassFrequencies() is separate.
   * \return width of the surroundings that a part needs for the labels of a run over
   * the whole cloud [m] */
  double setWhole(const CloudSample& whole);

  /** \brief Sets the cliques of the models `pn_potts` and `hierarchical`. Replaces a
   * generator.
   *
   * Cliques may overlap and need not cover all points. Points that are skipped or
   * outside setIndices() are removed from the cliques of a run. Cliques without
   * remaining members are skipped, see CRFReport::skipped_cliques. run() reports an
   * index out of range.
   * \param[in] cliques indices of points of the input cloud
   * \throws InvalidParameterException that names the clique, if a clique is empty */
  void setCliques(const std::vector<pcl::PointIndices>& cliques);

  /** \brief Sets a generator that makes the cliques of each run from the whole input
   * cloud. Replaces setCliques().
   *
   * The width and height of the cloud must be set. The generator gets points without a
   * position as NaN.
   * \param[in] generator null = no cliques */
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

  /** \brief Moves the refined distributions out, see getLabelDistributions(). */
  LabelDistributions
  takeLabelDistributions()
  {
    return std::exchange(refined_, LabelDistributions());
  }

  /** \brief Number of points skipped by the last filter().
   *
   * A point with a coordinate that is not finite or beyond max_coordinate gets label 0
   * and no distribution. Two or more points at exactly 0 0 0 (no-returns of a scanner)
   * keep their label and distribution, unless setVoxels() gives their positions. */
  std::size_t
  getSkippedPoints() const
  {
    return skipped_points_;
  }

  /** \brief Largest magnitude of a coordinate [m]. Single precision has steps of a
   * metre there. */
  static constexpr float max_coordinate = 1e7f;

  /** \brief Whether the coordinates are finite and within max_coordinate. */
  static bool
  hasPosition(const Eigen::Vector3f& position)
  {
    return (position.array().abs() <= max_coordinate).all(); // NaN fails
  }

  /** \brief Refines the points of the given indices.
   * \param[in,out] cloud the labels of these points are rewritten; positions and
   * colours are freed
   * \param[in] measured measurements from a field of the cloud, L x points. They are
   * used if neither setLabelDistributions() nor setLabelConfidence() was called; null =
   * no field
   * \param[in] cliques cliques from a field of the cloud. They are used if neither
   * cliques nor a generator were set; null = no field
   * \throws InvalidParameterException if a setting has not one entry per point of the
   * cloud, or there are no measurements
   * \throws BadInputException at an invalid label or distribution */
  void run(CloudFields& cloud, const pcl::Indices& indices,
           const LabelDistributions* measured = nullptr,
           const std::vector<pcl::PointIndices>* cliques = nullptr);

  /** \brief Does the work of run() for a cloud without points. Settings with one entry
   * per point are ignored. */
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

  /** \brief Converts numbers to labels. The upper 16 bits of a 32-bit number are an
   * instance (SemanticKITTI) and are removed. A number that is no label becomes 0,
   * unless labels are measurements.
   * \param[in] is_single the numbers were stored as floats. Floats hold integers
   * exactly below 2^24
   * \throws BadInputException that names the point, if labels are measurements and a
   * number is no label */
  std::vector<std::uint32_t> labelsOf(const std::vector<double>& numbers,
                                      bool is_single) const;

  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero(); ///< see setOrigin()
  bool judges_steps_ = true;                         ///< false once an origin was set
  Eigen::Matrix3Xf remainders_;                      ///< see setRemainders()

private:
  // Of the cloud whose part is refined.
  struct Whole {
    double spacing, extent;
    std::vector<KernelMethod> methods;
    Eigen::Vector3d low;        // [m]
    Eigen::Vector3f colour_low; // [grey levels]
  };

  LabelDistributions measurements(const CloudFields& cloud, const pcl::Indices& indices,
                                  const LabelDistributions* own);

  std::vector<pcl::PointIndices> makeCliques(const CloudFields& cloud) const;

  CRFElements elementsOf(const CloudFields& cloud, const pcl::Indices& valid) const;

  void setMethods(const std::vector<Eigen::Index>& sample, std::size_t points,
                  CRFElements& elements) const;

  LabelDistributions measured_;
  bool is_measured_once_ = false; // giveLabelDistributions()
  double label_confidence_ = 0.0;
  int label_classes_ = 0; // 0 = distributions were set
  std::vector<VoxelIndex> voxels_;
  double voxel_size_ = 0.0;
  std::optional<std::vector<pcl::PointIndices>> cliques_;
  CliqueGenerator::Ptr generator_;
  bool use_colour_ = true;
  std::optional<Whole> whole_;
  std::size_t tile_size_ = 250000;
  LabelDistributions refined_;
  std::size_t skipped_points_ = 0;
};

} // namespace pcl_semantic
