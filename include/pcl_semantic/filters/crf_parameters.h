// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/crf/gaussian_kernels.h>

#include <cstddef>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The models compared in the paper. Each adds a term to the previous one; the
 * last two differ in the clique term. */
enum class CRFModelType {
  unary,       ///< measurements only, eq. (4)
  dense,       ///< adds Gaussian kernels, eqs. (5)-(6)
  pn_potts,    ///< adds P^n Potts cliques (Vineet, Warrell and Torr 2014)
  hierarchical ///< adds robust P^n cliques with their own variables, eqs. (7)-(9)
};

/** \brief Sensor of the points of a cloud. It decides the automatic values of
 * SemanticCRFParameters. */
enum class PointSensor {
  automatic, ///< rgbd for points with colours, otherwise lidar
  stereo,    ///< depth from stereo, which is uncertain
  rgbd,      ///< precise depth and colours
  lidar      ///< precise depth without colours
};

/** \brief Parameters of the CRF over the points of a cloud [m] or the pixels of an
 * image [px]. A kernel of weight 0 is omitted. Without colours, the kernels with
 * colours use positions only, with the same weight.
 *
 * Values of 0 that are marked automatic depend on the sensor and on the spacing of the
 * points (doc/parameters.md): see resolved(). */
struct SemanticCRFParameters {
  double smoothness_weight = 3.0;    ///< w_2, of the kernel over positions only
  double smoothness_deviation = 0.0; ///< theta_gamma; 0 = automatic
  double appearance_weight = 8.0;    ///< w_1, of the kernel over positions and colours
  double appearance_deviation = 0.0; ///< theta_alpha; 0 = automatic
  double colour_deviation = 0.0; ///< theta_beta [grey levels, 0..255]; 0 = automatic

  KernelMethod kernel_method = KernelMethod::automatic;
  double radius = 2.0; ///< radius of truncated kernels [position deviations]
  Normalization normalization = Normalization::symmetric;
  bool self_interaction = false; ///< kernels include the point itself, as densecrf does

  int iterations = 0; ///< mean-field updates; 0 = automatic
  PointSensor sensor = PointSensor::automatic;
  /// T: raises the marginals to the power of 1/T and normalises them (Guo et al. 2017);
  /// doc/calibration.md. Labels do not change; above 1 their probabilities decrease.
  /// The unary model ignores T.
  double temperature = 1.0;
  /// Keeps the measurement of elements measured as a thin class, because most of their
  /// neighbours have other classes (CRFSettings::setThinLabels()). Such an element only
  /// changes if the messages favour another class by more than a factor of e^6.
  bool keep_thin = true;
  /// tau: divides each measurement by the frequencies of the classes to this power, at
  /// least 0.1 each, because a network's class frequencies are in every measurement,
  /// and rare classes lose to frequent ones (Menon et al. 2021, "Long-tail learning via
  /// logit adjustment"); CRFSettings::setClassFrequencies(). 0 = off; -1 = automatic.
  double logit_adjustment = 0.0;

  // Cliques of the last two models. All but the weight apply to the hierarchical model.
  double clique_weight = 2.0; ///< k_c, eq. (8)
  /// Inference starts from the cliques' messages, see CrfModel::start_from_cliques.
  bool clique_start = false;
  bool free_label = true; ///< a clique may have no label
  double clique_truncation =
      0.5; ///< q, the fraction of members that may disagree with the clique's label

  // Kernel between cliques, over the mean position and colour of their members.
  double clique_appearance_weight = 0.0;
  double clique_appearance_deviation = 1.0; ///< deviation of positions [m, px]
  double clique_colour_deviation = 8.0;     ///< deviation of colours [grey levels]

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;

  /** \brief Replaces automatic values:
   *
   * | | stereo | rgbd | lidar |
   * |---|---|---|---|
   * | updates | 1 | 3 | 3 |
   * | smoothness deviation [m] | 0.2 | 0.1 | 0.2 |
   * | appearance deviation [m] | 0.2 | 0.2 | 0.2 |
   * | colour deviation | 8 | 30 | |
   * | logit adjustment | 0 | 1 | 0 |
   *
   * Deviations are at least two and at most ten times the spacing; of rgbd, they are at
   * least one (smoothness) or two times (appearance) the spacing and at most an eighth
   * or a quarter of the extent. The logit adjustment is 1 only if rgbd is set, not if
   * it follows from colours.
   *
   * \param[in] spacing CRFReport::spacing; 0 = unknown
   * \param[in] has_colours whether the points have colours
   * \param[in] extent CRFReport::extent; 0 = unknown */
  SemanticCRFParameters resolved(double spacing, bool has_colours,
                                 double extent = 0.0) const;

  /** \brief Defaults for the voxels of a map: a temperature of 3, and the automatic
   * logit adjustment. */
  static SemanticCRFParameters forMaps();

  /** \brief Defaults for images: smoothness 3 px; appearance 40 px and 4 grey levels;
   * five updates; cliques of weight 1 and truncation 0.3. */
  static SemanticCRFParameters forImages();
};

/** \brief Report of a run of SemanticCRF or ImageCRF. */
struct CRFReport {
  /// Size of the voxels, or median distance of the points to their fourth nearest
  /// neighbour [m]; 0 = too few points.
  double spacing = 0.0;
  /// Median distance of the points to their median position [m]; 0 for voxels.
  double extent = 0.0;
  int updates = 0;                 ///< mean-field updates made
  std::size_t unlabelled = 0;      ///< refined elements without a measurement
  std::size_t cliques = 0;         ///< cliques with at least one refined element
  std::size_t skipped_cliques = 0; ///< other cliques; the run ignores them
};

} // namespace pcl_semantic
