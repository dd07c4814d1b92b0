// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_pass.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t widest = 16; // rows that are filtered at a time
// To wake threads costs more than to filter fewer rows than that by oneself.
constexpr std::size_t few_rows = 2000;

using Passes = std::vector<std::unique_ptr<LatticePass>>;

// Parts of all passes one after the other, for threads to share.
template <typename CountOf, typename Work>
void
share(const Passes& passes, bool by_threads, CountOf&& count_of, Work&& work)
{
  std::vector<std::size_t> ends;
  for (const auto& pass : passes)
    ends.push_back((ends.empty() ? 0 : ends.back()) + count_of(*pass));
#pragma omp parallel for schedule(dynamic, 1) if (by_threads)
  for (std::size_t i = 0; i < ends.back(); ++i) {
    std::size_t p = 0;
    while (i >= ends[p])
      ++p;
    work(*passes[p], i - (p > 0 ? ends[p - 1] : 0));
  }
}

void
run(const Passes& passes, std::size_t chunks, bool by_threads)
{
  // All passes of a chunk together: its values and results stay in the fast cache.
#pragma omp parallel for schedule(dynamic, 1) if (by_threads)
  for (std::size_t c = 0; c < chunks; ++c)
    for (const auto& pass : passes)
      pass->splat(c);
  share(
      passes, by_threads, [](const LatticePass& pass) { return pass.merges(); },
      [](const LatticePass& pass, std::size_t part) { pass.merge(part); });
  share(
      passes, by_threads, [](const LatticePass& pass) { return pass.copies(); },
      [](const LatticePass& pass, std::size_t part) { pass.copy(part); });
  std::size_t stages = 0;
  for (const auto& pass : passes)
    stages = std::max(stages, pass->stages());
  for (std::size_t s = 0; s < stages; ++s)
    share(
        passes, by_threads, [&](const LatticePass& pass) { return pass.blurs(s); },
        [&](const LatticePass& pass, std::size_t part) { pass.blur(s, part); });
#pragma omp parallel for schedule(dynamic, 1) if (by_threads)
  for (std::size_t c = 0; c < chunks; ++c)
    for (const auto& pass : passes)
      pass->slice(c);
}

} // namespace

class PermutohedralLattice::Implementation {
public:
  Implementation(const LatticeFeatures& features, const LatticeOrder& order,
                 SimdTier simd_tier)
      : structure(buildLattice(features, order, simd_tier)), tier(simd_tier)
  {}

  const LatticeStructure structure;
  const SimdTier tier;
  LatticeMemory memory;
};

PermutohedralLattice::PermutohedralLattice(
    const Eigen::Ref<const Eigen::MatrixXf>& features, SimdTier tier)
    : implementation_(std::make_unique<Implementation>(features, nullptr, tier))
{}

PermutohedralLattice::PermutohedralLattice(
    const Eigen::Ref<const Eigen::MatrixXf>& features,
    const PermutohedralLattice& neighbour, SimdTier tier)
{
  if (features.cols() != neighbour.size())
    PCL_THROW_EXCEPTION(InvalidParameterException,
                        "lattices to be filtered together are around "
                            << neighbour.size() << " and " << features.cols()
                            << " points");
  implementation_ = std::make_unique<Implementation>(
      features, neighbour.implementation_->structure.columns, tier);
}

PermutohedralLattice::~PermutohedralLattice() = default;
PermutohedralLattice::PermutohedralLattice(PermutohedralLattice&&) noexcept = default;
PermutohedralLattice&
PermutohedralLattice::operator=(PermutohedralLattice&&) noexcept = default;

Eigen::Index
PermutohedralLattice::size() const
{
  return Eigen::Index(implementation_->structure.points);
}

Eigen::VectorXd
PermutohedralLattice::origin() const
{
  const auto d = Eigen::Index(implementation_->structure.corners) - 1;
  return Eigen::Map<const Eigen::VectorXd>(implementation_->structure.frame.low, d);
}

Eigen::Index
PermutohedralLattice::vertices() const
{
  return Eigen::Index(implementation_->structure.vertices);
}

float
PermutohedralLattice::gain() const
{
  // The taps sum to 2 in each of d + 1 directions; a vertex stands for the volume
  // (3/2)^(d/2) / (d + 1)^(1/2) of the space of features.
  const auto corners = double(implementation_->structure.corners);
  const double pi = 3.14159265358979323846;
  return float(std::pow(4.0 * pi / 3.0, (corners - 1.0) / 2.0) * std::sqrt(corners) /
               std::exp2(corners));
}

Eigen::Map<const Eigen::ArrayXf>
PermutohedralLattice::selfResponses() const
{
  return {implementation_->structure.self_responses.data(), size()};
}

void
PermutohedralLattice::addFiltered(const Eigen::Ref<const Eigen::MatrixXf>& values,
                                  const std::vector<Term>& terms,
                                  Eigen::Ref<Eigen::MatrixXf> result, LatticeBlur blur)
{
  if (terms.empty() || values.cols() == 0)
    return;
  const LatticeStructure& first = terms[0].lattice->implementation_->structure;
  bool is_large = false;
  for (const Term& term : terms) {
    const LatticeStructure& structure = term.lattice->implementation_->structure;
    if (structure.columns != first.columns)
      PCL_THROW_EXCEPTION(InvalidParameterException,
                          "lattices to be filtered together were not made together");
    is_large |= structure.rows + structure.points > few_rows;
  }
  const float* const end = values.col(values.cols() - 1).data() + values.rows();
  for (Eigen::Index row = 0; row < values.rows(); row += Eigen::Index(widest)) {
    Passes passes;
    for (const Term& term : terms) {
      const kernels::LatticeColumns columns = {
          values.data() + row,
          end,
          std::size_t(values.outerStride()),
          result.data() + row,
          std::size_t(result.outerStride()),
          std::min(widest, std::size_t(values.rows() - row)),
          term.scales->splat.data(),
          term.scales->slice.data(),
          term.scales->diagonal.data()};
      Implementation& lattice = *term.lattice->implementation_;
      passes.push_back(std::make_unique<LatticePass>(lattice.structure, columns, blur,
                                                     lattice.tier, lattice.memory));
    }
    run(passes, first.chunks(), is_large);
  }
}

std::size_t
PermutohedralLattice::memory(LatticeBlur blur) const
{
  const LatticeStructure& structure = implementation_->structure;
  const std::size_t halves = blur == LatticeBlur::symmetric ? 2 : 1;
  return structure.memory() + structure.rows * halves * widest * sizeof(float);
}

} // namespace pcl_semantic
