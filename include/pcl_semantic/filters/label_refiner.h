// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/cliques/clique_generator.h>
#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/crf/crf_model.h>
#include <pcl_semantic/filters/crf_parameters.h>

#include <pcl/PointIndices.h>
#include <pcl/types.h>

#include <optional>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The common part of SemanticCRF and ImageCRF: the model over elements (points
 * of a cloud, pixels of an image), its settings, and the inference on matrices. */
class LabelRefiner {
public:
  /** \brief dense, unless it is set; the last two models need cliques. */
  void
  setModel(CRFModelType model)
  {
    model_ = model;
  }

  /** \throws InvalidParameterException */
  void setParameters(const SemanticCRFParameters& parameters);

  const SemanticCRFParameters&
  getParameters() const
  {
    return parameters_;
  }

  /** \brief mu(l, l') of eq. (5), L x L; empty = Potts.
   * \throws InvalidParameterException as LabelCompatibility */
  void setCompatibility(const Eigen::MatrixXf& costs);

  /** \brief Adds a Gaussian kernel of the caller's own, w exp(-|f_i - f_j|^2 / 2), to
   * all models but unary.
   * \param[in] features d x number of elements, divided by their deviations
   * \throws InvalidParameterException if there are no features or one is not finite, or
   * the weight is not 0 to 1e9 */
  void addKernel(const Eigen::MatrixXf& features, float weight);

  /** \brief psi_c(l), L x C, of the hierarchical model; empty = the mean unary cost of
   * the members. \throws InvalidParameterException unless all are finite */
  void setCliqueCosts(const Eigen::MatrixXf& costs);

  /** \brief Classes of things that are thinner than the kernels are wide; see
   * SemanticCRFParameters::keep_thin. None unless it is set. One that there is not is
   * found in the run. */
  void
  setThinLabels(const std::vector<Label>& labels)
  {
    thin_labels_ = labels;
  }

  /** \brief Threads of a run; 0 = all processors. Unless it is set: as many as OpenMP
   * gives the calling thread. The result does not depend on it. */
  void
  setNumberOfThreads(int threads)
  {
    threads_ = threads;
  }

  /** \brief Of the last run. */
  const CRFReport&
  getReport() const
  {
    return report_;
  }

protected:
  std::optional<int> threads_;

  /** \brief The cliques of the last two models, as indices of elements; they may
   * overlap and leave elements out. Members that take no part are left out of their
   * cliques, and cliques that lose all are skipped (CRFReport).
   * \throws InvalidParameterException that names the clique, if one is empty; an index
   * out of range is found in the run */
  void setCliques(const std::vector<pcl::PointIndices>& cliques);

  /** \brief The elements that take part, and what is known of them. */
  struct Elements {
    std::size_t total = 0;     ///< elements of the whole cloud or image
    pcl::Indices indices;      ///< of the n that take part, each once
    Eigen::MatrixXf positions; ///< 1 to 3 rows x n, finite
    Eigen::MatrixXf colours;   ///< rows x n [grey levels]; empty = no colour
    double spacing = 0.0;      ///< CRFReport::spacing
  };

  ~LabelRefiner() = default;

  /** \brief Runs the model.
   * \param[in,out] elements are brought into the order that suits the kernels
   * \param[in,out] distributions of the whole cloud or image: the columns of the
   * elements hold their measurements and then the refined distributions; an element
   * without measurement that receives no message stays unlabelled
   * \throws InvalidParameterException if something that was set does not fit
   * \throws BadInputException if a measurement is negative or not finite */
  void refine(Elements& elements, LabelDistributions& distributions);

  /** \brief Of a run over no elements. */
  void
  clearReport()
  {
    report_ = CRFReport();
  }

  bool
  usesCliques() const
  {
    return model_ == CRFModelType::pn_potts || model_ == CRFModelType::hierarchical;
  }

  std::vector<pcl::PointIndices> cliques_;
  bool has_cliques_ = false;

private:
  class Builder;

  CRFModelType model_ = CRFModelType::dense;
  SemanticCRFParameters parameters_;
  LabelCompatibility compatibility_;
  std::vector<GaussianTerm> kernels_; // the caller's own: weights and features
  Eigen::MatrixXf clique_costs_;
  std::vector<Label> thin_labels_;
  CRFReport report_;
};

} // namespace pcl_semantic
