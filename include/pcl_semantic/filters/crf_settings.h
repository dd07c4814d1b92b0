// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/crf/crf_model.h>
#include <pcl_semantic/filters/crf_parameters.h>

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief The terms of a CRF, for any kind of elements. */
struct CRFTerms {
  CRFModelType model = CRFModelType::dense;
  SemanticCRFParameters parameters;
  LabelCompatibility compatibility;  ///< mu, eq. (5)
  std::vector<GaussianTerm> kernels; ///< the caller's own: weights and features
  std::vector<Label> thin_labels;
  Eigen::VectorXd class_frequencies; ///< L, sum 1; empty = of the measurements
  std::optional<int> threads;        ///< none: OpenMP's number for the calling thread
  std::function<void()> check_interruption; ///< may throw; null = none

  bool
  usesCliques() const
  {
    return model == CRFModelType::pn_potts || model == CRFModelType::hierarchical;
  }

  void
  checkInterruption() const
  {
    if (check_interruption)
      check_interruption();
  }
};

/** \brief The common settings of SemanticCRF and ImageCRF. */
class CRFSettings {
public:
  /** \brief Selects the model, dense by default. The last two models need cliques. */
  void
  setModel(CRFModelType model)
  {
    terms_.model = model;
  }

  /** \throws InvalidParameterException as SemanticCRFParameters::validate() */
  void setParameters(const SemanticCRFParameters& parameters);

  const SemanticCRFParameters&
  getParameters() const
  {
    return terms_.parameters;
  }

  /** \brief Sets mu(l, l') of eq. (5), L x L; empty = Potts.
   * \throws InvalidParameterException as LabelCompatibility */
  void setCompatibility(const Eigen::MatrixXf& costs);

  /** \brief Adds a Gaussian kernel, w exp(-|f_i - f_j|^2 / 2), to all models but unary.
   * \param[in] features d x number of elements, divided by their deviations
   * \throws InvalidParameterException if there are no features or one is not finite, or
   * the weight is not 0 to 1e9 */
  void addKernel(const Eigen::MatrixXf& features, float weight);

  /** \brief Sets the classes of objects thinner than the kernels are wide, see
   * SemanticCRFParameters::keep_thin. None by default. The run reports a class that
   * does not exist. */
  void
  setThinLabels(const std::vector<Label>& labels)
  {
    terms_.thin_labels = labels;
  }

  /** \brief Sets the frequencies of the classes for
   * SemanticCRFParameters::logit_adjustment, L with sum 1; empty = the mean of the
   * measurements of the run. Set those of a whole map to refine a part of it.
   * \throws InvalidParameterException if a frequency is negative or not finite */
  void setClassFrequencies(const Eigen::VectorXd& frequencies);

  /** \brief Sets the threads of a run; 0 = all processors, default = OpenMP's number
   * for the calling thread. The result does not depend on it. */
  void
  setNumberOfThreads(int threads)
  {
    terms_.threads = threads;
  }

  /** \brief Sets a function that the calling thread calls between the steps of a run:
   * before each kernel and each update, among others. If it throws, the run ends with
   * that exception. Use it to answer Ctrl-C. None by default. */
  void
  setInterruptionCheck(std::function<void()> check)
  {
    terms_.check_interruption = std::move(check);
  }

  /** \brief Report of the last run. */
  const CRFReport&
  getReport() const
  {
    return report_;
  }

protected:
  ~CRFSettings() = default;

  CRFTerms terms_;
  CRFReport report_;
};

} // namespace pcl_semantic
