// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_kernel.h"
#include "requirements.h"

namespace pcl_semantic {

LatticeKernel::LatticeKernel(const Eigen::Ref<const Eigen::MatrixXf>& features,
                             float weight, Normalization normalization, SimdTier tier)
    : lattice_(features, tier)
{
  requireWeight(weight);
  scales_.splat = Eigen::ArrayXf::Ones(size());
  scales_.slice = Eigen::ArrayXf::Ones(size());
  scales_.diagonal = Eigen::ArrayXf::Zero(size());
  if (normalization == Normalization::none) {
    scales_.slice *= weight * lattice_.gain();
  }
  else {
    Eigen::MatrixXf sums = Eigen::MatrixXf::Zero(1, size());
    addProduct(Eigen::MatrixXf::Ones(1, size()), sums);
    scales_.slice = weight / sums.row(0).transpose().array();
    if (normalization == Normalization::symmetric)
      scales_.splat = scales_.slice = scales_.slice.sqrt();
  }
  scales_.diagonal = lattice_.selfResponses() * scales_.slice * scales_.splat;
}

} // namespace pcl_semantic
