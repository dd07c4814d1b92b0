// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_kernel.h"

#include <pcl_semantic/core/exceptions.h>

#include <cmath>

namespace pcl_semantic {

namespace {

// The scales of one term, of a lattice of its own or together with others.
PermutohedralLattice::Scales
scalesFor(const PermutohedralLattice& lattice, float weight,
          Normalization normalization, LatticeBlur blur)
{
  PermutohedralLattice::Scales scales;
  scales.splat = Eigen::ArrayXf::Ones(lattice.size());
  scales.slice = Eigen::ArrayXf::Ones(lattice.size());
  scales.diagonal = Eigen::ArrayXf::Zero(lattice.size());
  if (normalization == Normalization::none) {
    scales.slice *= weight * lattice.gain();
  }
  else {
    Eigen::MatrixXf sums = Eigen::MatrixXf::Zero(1, lattice.size());
    PermutohedralLattice::addFiltered(Eigen::MatrixXf::Ones(1, lattice.size()),
                                      {{&lattice, &scales}}, sums, blur);
    scales.slice = weight / sums.row(0).transpose().array();
    if (normalization == Normalization::symmetric)
      scales.splat = scales.slice = scales.slice.sqrt();
  }
  scales.diagonal = lattice.selfResponses() * scales.slice * scales.splat;
  return scales;
}

} // namespace

LatticeKernel::LatticeKernel(const std::vector<LatticeTerm>& terms,
                             Normalization normalization, LatticeBlur blur,
                             SimdTier tier)
    : blur_(blur)
{
  if (terms.empty())
    PCL_THROW_EXCEPTION(InvalidParameterException, "a lattice kernel has no terms");
  lattices_.reserve(terms.size());
  scales_.reserve(terms.size());
  diagonal_ = Eigen::ArrayXf::Zero(terms[0].features.cols());
  for (const LatticeTerm& term : terms) {
    if (!(term.weight >= 0.0f) || !std::isfinite(term.weight))
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "kernel weight is " << term.weight << ", expected 0 or more");
    if (lattices_.empty())
      lattices_.emplace_back(term.features, tier);
    else
      lattices_.emplace_back(term.features, lattices_[0], tier);
    scales_.push_back(scalesFor(lattices_.back(), term.weight, normalization, blur));
    terms_.push_back({&lattices_.back(), &scales_.back()});
    diagonal_ += scales_.back().diagonal;
  }
}

void
LatticeKernel::addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                          Eigen::Ref<Eigen::MatrixXf> result) const
{
  PermutohedralLattice::addFiltered(values, terms_, result, blur_);
}

std::size_t
LatticeKernel::memory() const
{
  std::size_t bytes = std::size_t(size()) * sizeof(float);
  for (const PermutohedralLattice& lattice : lattices_)
    bytes += lattice.memory(blur_) + 3 * sizeof(float) * std::size_t(size());
  return bytes;
}

} // namespace pcl_semantic
