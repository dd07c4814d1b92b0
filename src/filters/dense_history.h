// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/crf/crf_model.h>
#include <pcl_semantic/crf/gaussian_term.h>

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcl_semantic {

/** \brief A dense CRF over points, of which one update is wanted. */
struct DenseProblem {
  Eigen::Vector3d origin; ///< of the positions
  Eigen::Matrix3Xf positions;
  Eigen::MatrixXf colours; ///< rows x N; may be empty
  Eigen::MatrixXf measured;
  std::vector<GaussianTerm> terms; ///< of one position deviation
  float radius = 2.0f;
  Normalization normalization = Normalization::symmetric;
  bool self_interaction = false;
  LabelCompatibility compatibility;
};

/** \brief What was computed of a cloud, from which the next one takes all that cannot
 * have changed: results are those of a run without it, up to rounding. Parameters have
 * to be the same. */
class DenseHistory {
public:
  using Places = std::vector<std::array<std::int64_t, 3>>; ///< z, y, x, in step()s

  /** \brief One update of a cloud. \param[in] before null = of all points */
  static std::shared_ptr<const DenseHistory> update(DenseProblem&& problem,
                                                    const DenseHistory* before);

  /** \brief Marginals, L x N. */
  const Eigen::MatrixXf&
  marginals() const
  {
    return marginals_;
  }

  /** \brief The largest change of a marginal that was computed anew. */
  double
  lastChange() const
  {
    return last_change_;
  }

  /** \brief Points whose marginals are those of the cloud before. */
  std::size_t
  takenOver() const
  {
    return taken_over_;
  }

private:
  void findPlaces(const DenseProblem& problem);
  Eigen::Matrix3Xf findGone(const std::vector<std::int32_t>& same,
                            const Eigen::Vector3d& origin) const;
  void computeAll(const DenseProblem& problem);
  bool computeChanges(const DenseProblem& problem, const DenseHistory& before);

  double
  step() const
  {
    return double(radius_) * 1e-3;
  }

  float radius_ = 0.0f; // of the kernels
  Places places_;
  Eigen::MatrixXf colours_;
  Eigen::MatrixXf measured_;
  Eigen::MatrixXf sums_; // of the kernels, terms x N
  Eigen::MatrixXf marginals_;
  double last_change_ = 0.0;
  std::size_t taken_over_ = 0;
};

} // namespace pcl_semantic
