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

/** \brief Parameters of the CRF over the points of a cloud [m] or the pixels of an
 * image [px]. A kernel of weight 0 is omitted. Without colours, the kernels with
 * colours use positions only, with the same weight. */
struct SemanticCRFParameters {
  double smoothness_weight = 3.0;    ///< w_2, of the kernel over positions only
  double smoothness_deviation = 0.0; ///< theta_gamma; 0 = automaticDeviation()
  double appearance_weight = 8.0;    ///< w_1, of the kernel over positions and colours
  double appearance_deviation = 0.0; ///< theta_alpha; 0 = automaticDeviation()
  double colour_deviation = 8.0;     ///< theta_beta [grey levels, 0..255]

  KernelMethod kernel_method = KernelMethod::automatic;
  double radius = 2.0; ///< radius of truncated kernels [position deviations]
  Normalization normalization = Normalization::symmetric;
  bool self_interaction = false; ///< kernels include the point itself, as densecrf does

  int iterations = 1; ///< mean-field updates
  /// T: raises the marginals to the power of 1/T and normalises them (Guo et al. 2017);
  /// doc/calibration.md. Labels do not change; above 1 their probabilities decrease.
  /// The unary model ignores T.
  double temperature = 1.0;
  /// Keeps the measurement of elements measured as a thin class, because most of their
  /// neighbours have other classes (CRFSettings::setThinLabels()). Such an element only
  /// changes if the messages favour another class by more than a factor of e^6.
  bool keep_thin = true;

  // Cliques of the last two models. All but the weight apply to the hierarchical model.
  double clique_weight = 1.0; ///< k_c, eq. (8)
  bool free_label = true;     ///< a clique may have no label
  double clique_truncation =
      0.3; ///< q, the fraction of members that may disagree with the clique's label
  bool update_from_members =
      true; ///< update Q(y_c) from the members; false: from the clique costs only

  // Kernel between cliques, over the mean position and colour of their members.
  double clique_appearance_weight = 0.0;
  double clique_appearance_deviation = 1.0; ///< deviation of positions [m, px]
  double clique_colour_deviation = 8.0;     ///< deviation of colours [grey levels]

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;

  /** \brief Default deviation of positions for a cloud: 0.2 m, but at least two and at
   * most ten times the point spacing; doc/parameters.md.
   * \param[in] spacing CRFReport::spacing; 0 = unknown */
  static double automaticDeviation(double spacing);

  /** \brief Defaults for the voxels of a map: a temperature of 3. */
  static SemanticCRFParameters forMaps();

  /** \brief Defaults for images: smoothness 3 px; appearance 40 px and 4 grey levels;
   * five updates. */
  static SemanticCRFParameters forImages();
};

/** \brief Report of a run of SemanticCRF or ImageCRF. */
struct CRFReport {
  /// Size of the voxels, or median distance of the points to their fourth nearest
  /// neighbour [m]; 0 = too few points.
  double spacing = 0.0;
  int updates = 0;                 ///< mean-field updates made
  std::size_t unlabelled = 0;      ///< refined elements without a measurement
  std::size_t cliques = 0;         ///< cliques with at least one refined element
  std::size_t skipped_cliques = 0; ///< other cliques; the run ignores them
};

} // namespace pcl_semantic
