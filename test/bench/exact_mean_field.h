// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/voxel_cloud.h>
#include <pcl_semantic/filters/semantic_crf.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unordered_map>
#include <vector>

namespace pcl_semantic {

/** \brief The pairs of a voxel cloud within 5 deviations and their weights, in double
 * precision: two Gaussian kernels, each normalised symmetrically. */
class ExactKernel {
public:
  ExactKernel(const VoxelCloud& voxels, const SemanticCRFParameters& parameters)
      : neighbours_(voxels.size()), weights_(voxels.size())
  {
    std::unordered_map<VoxelIndex, int, VoxelIndexHash> grid;
    for (std::size_t i = 0; i < voxels.size(); ++i)
      grid[voxels.indices[i]] = int(i);
    const SemanticCRFParameters values = parameters.resolved(voxels.voxel_size, true);
    const double smooth = voxels.voxel_size / values.smoothness_deviation;
    const double appear = voxels.voxel_size / values.appearance_deviation;
    const int reach = int(5.0 / std::min(smooth, appear) + 1e-9);
    std::vector<std::vector<double>> first(voxels.size()), second(voxels.size());
    std::vector<double> first_sum(voxels.size()), second_sum(voxels.size());
#pragma omp parallel for schedule(dynamic, 64)
    for (std::size_t i = 0; i < voxels.size(); ++i)
      for (int z = -reach; z <= reach; ++z)
        for (int y = -reach; y <= reach; ++y)
          for (int x = -reach; x <= reach; ++x) {
            const int squared = x * x + y * y + z * z;
            const auto found = squared <= reach * reach
                                   ? grid.find(voxels.indices[i] + VoxelIndex(x, y, z))
                                   : grid.end();
            if (found == grid.end())
              continue;
            const auto &a = (*voxels.cloud)[i],
                       &b = (*voxels.cloud)[std::size_t(found->second)];
            const double dr = double(a.r) - b.r, dg = double(a.g) - b.g,
                         db = double(a.b) - b.b;
            const double colour =
                (dr * dr + dg * dg + db * db) / std::pow(values.colour_deviation, 2);
            neighbours_[i].push_back(found->second);
            first[i].push_back(std::exp(-0.5 * squared * smooth * smooth));
            second[i].push_back(std::exp(-0.5 * (squared * appear * appear + colour)));
            first_sum[i] += first[i].back();
            second_sum[i] += second[i].back();
          }
#pragma omp parallel for schedule(dynamic, 64)
    for (std::size_t i = 0; i < voxels.size(); ++i)
      for (std::size_t e = 0; e < neighbours_[i].size(); ++e) {
        const auto j = std::size_t(neighbours_[i][e]);
        const bool own = j == i && !parameters.self_interaction;
        weights_[i].push_back(own ? 0.0
                                  : parameters.smoothness_weight * first[i][e] /
                                            std::sqrt(first_sum[i] * first_sum[j]) +
                                        parameters.appearance_weight * second[i][e] /
                                            std::sqrt(second_sum[i] * second_sum[j]));
      }
  }

  /** \brief Mean-field updates of the Potts model. */
  Eigen::MatrixXd
  run(const LabelDistributions& measured, int iterations) const
  {
    const Eigen::MatrixXd costs =
        -measured.matrix().array().max(1e-6f).log().cast<double>();
    Eigen::MatrixXd marginals = softMaxColumns(-costs);
    for (int t = 0; t < iterations; ++t) {
      Eigen::MatrixXd logs = -costs;
#pragma omp parallel for schedule(dynamic, 64)
      for (std::size_t i = 0; i < neighbours_.size(); ++i)
        for (std::size_t e = 0; e < neighbours_[i].size(); ++e)
          logs.col(Eigen::Index(i)) +=
              weights_[i][e] * marginals.col(neighbours_[i][e]);
      marginals = softMaxColumns(std::move(logs));
    }
    return marginals;
  }

private:
  static Eigen::MatrixXd
  softMaxColumns(Eigen::MatrixXd logs)
  {
    for (Eigen::Index i = 0; i < logs.cols(); ++i) {
      logs.col(i) = (logs.col(i).array() - logs.col(i).maxCoeff()).exp();
      logs.col(i) /= logs.col(i).sum();
    }
    return logs;
  }

  std::vector<std::vector<int>> neighbours_;
  std::vector<std::vector<double>> weights_;
};

/** \brief Deviation of marginals from exact ones: fraction of equal MAP labels, mean
 * and 99th percentile of the largest difference per voxel. */
struct MarginalError {
  double equal = 0.0, mean = 0.0, percentile99 = 0.0;

  MarginalError(const Eigen::MatrixXf& marginals, const Eigen::MatrixXd& exact)
  {
    std::vector<double> differences;
    for (Eigen::Index i = 0; i < exact.cols(); ++i) {
      Eigen::Index ours = 0, theirs = 0;
      marginals.col(i).maxCoeff(&ours);
      exact.col(i).maxCoeff(&theirs);
      equal += double(ours == theirs) / double(exact.cols());
      differences.push_back(
          (marginals.col(i).cast<double>() - exact.col(i)).cwiseAbs().maxCoeff());
      mean += differences.back() / double(exact.cols());
    }
    const auto place = differences.begin() + long(differences.size() * 99 / 100);
    std::nth_element(differences.begin(), place, differences.end());
    percentile99 = *place;
  }
};

} // namespace pcl_semantic
