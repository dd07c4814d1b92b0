/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/crf/lattice_kernel.h>

#include <cmath>

namespace pcl_semantic {

LatticeKernel::LatticeKernel(const Eigen::Ref<const Eigen::MatrixXf>& features,
                             float weight, Normalization normalization,
                             LatticeBlur blur, SimdTier tier)
    : lattice_(features, tier), blur_(blur)
{
  if (!(weight >= 0.0f) || !std::isfinite(weight))
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "kernel weight is " << weight << ", expected 0 or more");
  scales_.splat = Eigen::ArrayXf::Ones(size());
  scales_.slice = Eigen::ArrayXf::Ones(size());
  scales_.diagonal = Eigen::ArrayXf::Zero(size());
  if (normalization == Normalization::none) {
    scales_.slice *= weight * lattice_.gain();
  }
  else {
    Eigen::MatrixXf sums = Eigen::MatrixXf::Zero(1, size());
    lattice_.addFiltered(Eigen::MatrixXf::Ones(1, size()), scales_, {}, sums, blur_);
    if (normalization == Normalization::symmetric)
      scales_.splat = scales_.slice = (weight / sums.row(0).transpose().array()).sqrt();
    else
      scales_.slice = weight / sums.row(0).transpose().array();
  }
  scales_.diagonal = lattice_.selfResponses() * scales_.slice * scales_.splat;
}

void
LatticeKernel::addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                          Eigen::Ref<Eigen::MatrixXf> result,
                          const VariableMask& active) const
{
  lattice_.addFiltered(values, scales_, active, result, blur_);
}

std::size_t
LatticeKernel::memory() const
{
  return lattice_.memory(blur_) + 3 * sizeof(float) * std::size_t(size());
}

} // namespace pcl_semantic
