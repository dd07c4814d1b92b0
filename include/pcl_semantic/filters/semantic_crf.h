/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <pcl_semantic/core/label_distributions.h>

#include <pcl/filters/filter.h>

#include <memory>

namespace pcl_semantic {

/** \brief Parameters of the dense pairwise CRF, eq. (6) of the paper. The second kernel
 * is used where points have colour. */
struct SemanticCRFParameters {
  double smoothness_weight = 3.0;    ///< w_2, of the kernel of positions alone
  double smoothness_deviation = 0.2; ///< theta_gamma [m]
  double appearance_weight = 8.0;    ///< w_1, of the kernel of positions and colours
  double appearance_deviation = 0.2; ///< theta_alpha [m]
  double colour_deviation = 8.0;     ///< theta_beta [grey levels, 0..255]
  double radius = 2.5;               ///< kernels are summed within this many deviations
  int iterations = 1;                ///< mean-field updates

  /** \throws InvalidParameterException */
  void validate() const;
};

/** \brief Makes the labels of a cloud consistent: mean field in a dense CRF over its
 * points (Kraehenbuehl and Koltun 2011; section IV of the paper).
 *
 * A pcl::Filter that removes nothing: the output is the input with the `label` of the
 * points of setIndices() rewritten; organization is kept. Points that are not finite
 * keep their place with label 0. Works for point types with xyz and a label.
 * \note Points outside setIndices() keep their label and distribution, and neither send
 * nor receive messages. */
template <typename PointT> class SemanticCRF : public pcl::Filter<PointT> {
public:
  using Ptr = std::shared_ptr<SemanticCRF<PointT>>;
  using ConstPtr = std::shared_ptr<const SemanticCRF<PointT>>;
  using typename pcl::Filter<PointT>::PointCloud;

  SemanticCRF() { this->filter_name_ = "SemanticCRF"; }

  /** \brief The measurements: L x size of the input cloud; all-zero columns are
   * unlabelled and take the label of their neighbours, if one of these has any. */
  void
  setLabelDistributions(const LabelDistributions& distributions)
  {
    input_distributions_ = distributions;
  }

  /** \throws InvalidParameterException */
  void
  setParameters(const SemanticCRFParameters& parameters)
  {
    parameters.validate();
    parameters_ = parameters;
  }

  const SemanticCRFParameters&
  getParameters() const
  {
    return parameters_;
  }

  /** \brief The refined distributions of the last filter(): L x size of the cloud. */
  const LabelDistributions&
  getLabelDistributions() const
  {
    return output_distributions_;
  }

  /** \brief Points of the last filter() that were passed over as not finite. */
  std::size_t
  getSkippedPoints() const
  {
    return skipped_points_;
  }

protected:
  /** \throws InvalidParameterException if the distributions do not fit the cloud */
  void applyFilter(PointCloud& output) override;

private:
  SemanticCRFParameters parameters_;
  LabelDistributions input_distributions_;
  LabelDistributions output_distributions_;
  std::size_t skipped_points_ = 0;
};

/** \brief The work of SemanticCRF on matrices.
 * \param[in] positions 3 x N, finite [m]
 * \param[in] colours 3 x N, 0..255; empty = no appearance kernel
 * \param[in] measured L x N
 * \return refined distributions, L x N */
LabelDistributions refineLabels(const Eigen::Matrix3Xf& positions,
                                const Eigen::MatrixXf& colours,
                                const LabelDistributions& measured,
                                const SemanticCRFParameters& parameters);

} // namespace pcl_semantic

#include <pcl_semantic/filters/impl/semantic_crf.hpp>
