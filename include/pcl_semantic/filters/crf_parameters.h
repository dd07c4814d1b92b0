// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/crf/gaussian_kernels.h>

#include <cstddef>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The models of the paper's comparison, each with the terms of the one before
 * it, but for the last two, which differ in the term of the cliques. */
enum class CRFModelType {
  unary,       ///< the measurements alone, eq. (4)
  dense,       ///< and Gaussian kernels, eqs. (5)-(6)
  pn_potts,    ///< and P^n Potts cliques (Vineet, Warrell and Torr 2014)
  hierarchical ///< and robust P^n cliques with variables of their own, eqs. (7)-(9)
};

/** \brief Parameters of the CRF over the points of a cloud [m] or the pixels of an
 * image [px]. A kernel of weight 0 is left out. Where points have no colour, those with
 * colours are of positions alone, with the same weight. */
struct SemanticCRFParameters {
  double smoothness_weight = 3.0;    ///< w_2, of the kernel of positions alone
  double smoothness_deviation = 0.0; ///< theta_gamma; 0 = automaticDeviation()
  double appearance_weight = 8.0;    ///< w_1, of the kernel of positions and colours
  double appearance_deviation = 0.0; ///< theta_alpha; 0 = automaticDeviation()
  double colour_deviation = 8.0;     ///< theta_beta [grey levels, 0..255]

  KernelMethod kernel_method = KernelMethod::automatic;
  double radius = 2.0; ///< of truncated sums [position deviations]
  Normalization normalization = Normalization::symmetric;
  bool self_interaction = false; ///< kernels include the point itself, as densecrf does

  int iterations = 1; ///< mean-field updates
  /// T: what is returned of the marginals Q is Q^(1/T), normalised. The label stays,
  /// but it is less sure of itself (Guo et al. 2017); doc/calibration.md. The unary
  /// model has none.
  double temperature = 1.0;
  /// What was measured as a thin thing (CRFSettings::setThinLabels()) stays one: those
  /// around it are of other classes and outvote it; unless it is by more than e^6.
  bool keep_thin = true;

  // The cliques of the last two models; all but the weight: of the hierarchical one.
  double clique_weight = 1.0; ///< k_c, eq. (8)
  bool free_label = true;     ///< a clique may let go of its members
  double clique_truncation =
      0.3; ///< q, the fraction of members that may disagree before
  bool update_from_members = true; ///< else Q(y_c) follows from the clique costs alone

  // The kernel between cliques, over the mean position and colour of their members.
  double clique_appearance_weight = 0.0;
  double clique_appearance_deviation = 1.0; ///< of positions
  double clique_colour_deviation = 8.0;     ///< of colours [grey levels]

  /** \throws InvalidParameterException that names the parameter and its range */
  void validate() const;

  /** \brief The deviation of positions that suits a cloud: 0.2 m, but at least two and
   * at most ten times the distance of its points; doc/parameters.md.
   * \param[in] spacing CRFReport::spacing; 0 = not known */
  static double automaticDeviation(double spacing);

  /** \brief Defaults for the voxels of a map: a temperature of 3. */
  static SemanticCRFParameters forMaps();

  /** \brief Defaults for images: 3 px; 40 px and 4 grey levels; five updates. */
  static SemanticCRFParameters forImages();
};

/** \brief Report of a run of SemanticCRF or ImageCRF. */
struct CRFReport {
  /// The size of the voxels, or the median distance of the points to their fourth
  /// nearest neighbour [m]; 0 = too few points.
  double spacing = 0.0;
  int updates = 0;                 ///< mean-field updates made
  std::size_t unlabelled = 0;      ///< elements that take part without a measurement
  std::size_t cliques = 0;         ///< cliques that take part
  std::size_t skipped_cliques = 0; ///< cliques of which no member does
};

} // namespace pcl_semantic
