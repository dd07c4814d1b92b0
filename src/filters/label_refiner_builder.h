// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/crf/crf_model.h>
#include <pcl_semantic/filters/label_refiner.h>

namespace pcl_semantic {

/** \brief Makes the CrfModel of a LabelRefiner over elements. */
class LabelRefiner::Builder {
public:
  /** \brief Brings the elements into the order that suits the kernels.
   * \param[in] measured of all elements */
  Builder(LabelRefiner& refiner, Elements& elements,
          const LabelDistributions& measured);

  /** \throws as LabelRefiner::refine() */
  CrfModel build();

  /** \brief Marginals to start from, L x n; empty = from the measurements. */
  Eigen::MatrixXf initial() const;

private:
  void reorder(const std::vector<std::int32_t>& order);

  std::vector<GaussianTerm> terms() const;

  GaussianKernels::List kernels() const;

  void addCliques(CrfModel& model);

  std::vector<std::vector<std::int32_t>>
  cliquesOfElements(std::vector<int>& kept) const;

  GaussianKernels::List
  cliqueKernels(const std::vector<std::vector<std::int32_t>>& cliques) const;

  bool
  hasColours() const
  {
    return elements_.colours.size() > 0;
  }

  LabelRefiner& refiner_;
  const SemanticCRFParameters& parameters_;
  Elements& elements_;
  const LabelDistributions& measured_;
  GaussianKernels gaussian_kernels_;
};

} // namespace pcl_semantic
