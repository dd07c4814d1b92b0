// SPDX-License-Identifier: BSD-3-Clause
#include "permutohedral_lattice.h"
#include "kernels/lattice_filter.h"
#include "lattice_structure.h"

#include <pcl_semantic/core/exceptions.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>

namespace pcl_semantic {

namespace {

/** \brief Memory for the values on a lattice, kept from one product to the next: to get
 * it costs more than to fill it. Threads may use it at a time. */
class LatticeMemory {
public:
  using Values = std::shared_ptr<LatticeArray<float>>;

  Values borrow(std::size_t size);
  void giveBack(const Values& values);

private:
  std::mutex mutex_;
  std::vector<Values> spare_;
};

/** \brief The way of up to 16 rows of values over a lattice, in parts that threads
 * share: first every splat, then every merge, every copy, every blur of a stage after
 * those of the stage before, and every slice. */
class LatticePass {
public:
  LatticePass(const LatticeStructure& structure, const kernels::LatticeColumns& columns,
              LatticeBlur order, SimdTier tier, LatticeMemory& memory);
  ~LatticePass() { memory_.giveBack(values_); }
  LatticePass(const LatticePass&) = delete;
  LatticePass& operator=(const LatticePass&) = delete;

  /** \brief Floats of a row for a number of rows of interest. */
  static std::size_t
  widthFor(std::size_t rows)
  {
    return rows > 8 ? 16 : rows > 4 ? 8 : rows > 1 ? 4 : 1;
  }

  void
  splat(std::size_t chunk) const
  {
    loops_.splat(points(chunk), columns_, forward_);
  }

  std::size_t merges() const;
  void merge(std::size_t part) const;

  /** \brief Copies of the values to the half that is blurred in reverse. */
  std::size_t copies() const;
  void copy(std::size_t part) const;

  std::size_t
  stages() const
  {
    return structure_.groups.size();
  }

  std::size_t blurs(std::size_t stage) const;
  void blur(std::size_t stage, std::size_t part) const;

  void
  slice(std::size_t chunk) const
  {
    loops_.slice(points(chunk), columns_, forward_, half_);
  }

private:
  kernels::LatticePoints points(std::size_t chunk) const;

  const LatticeStructure& structure_;
  const kernels::LatticeColumns columns_;
  LatticeMemory& memory_;
  std::size_t width_;
  std::size_t half_;
  const kernels::LatticeFilter& loops_;
  LatticeMemory::Values values_;
  float* forward_; // blurred in the order of directions
  float* reverse_; // blurred in the reverse order; or null
};

constexpr std::size_t part_rows = 1024; // that a thread takes at a time

std::size_t
partsOf(std::size_t rows)
{
  return (rows + part_rows - 1) / part_rows;
}

LatticeMemory::Values
LatticeMemory::borrow(std::size_t size)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  while (!spare_.empty()) {
    Values values = spare_.back();
    spare_.pop_back();
    if (values->size() >= size)
      return values;
  }
  return std::make_shared<LatticeArray<float>>(size);
}

void
LatticeMemory::giveBack(const Values& values)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  spare_.push_back(values);
}

LatticePass::LatticePass(const LatticeStructure& structure,
                         const kernels::LatticeColumns& columns, LatticeBlur order,
                         SimdTier tier, LatticeMemory& memory)
    : structure_(structure), columns_(columns), memory_(memory),
      width_(widthFor(columns.rows)), half_(structure.rows * width_),
      loops_(kernels::latticeFilter(tier, width_,
                                    order == LatticeBlur::symmetric ? 2 : 1)),
      values_(memory.borrow(order == LatticeBlur::symmetric ? 2 * half_ : half_)),
      forward_(values_->data()),
      reverse_(order == LatticeBlur::symmetric ? forward_ + half_ : nullptr)
{}

kernels::LatticePoints
LatticePass::points(std::size_t chunk) const
{
  const std::size_t begin = chunk * structure_.chunk_points;
  const std::size_t partial = structure_.first_partials[chunk];
  return {std::min(structure_.chunk_points, structure_.points - begin),
          structure_.corners,
          structure_.columns->data() + begin,
          structure_.corner_rows.data() + begin * structure_.corners,
          structure_.weights.data() + begin * structure_.corners,
          structure_.row_ends.data() + begin / kernels::row_end_points,
          structure_.first_rows[chunk],
          structure_.vertices + partial,
          structure_.first_partials[chunk + 1] - partial,
          structure_.represents.data() + partial};
}

std::size_t
LatticePass::merges() const
{
  return partsOf(structure_.shared.size());
}

void
LatticePass::merge(std::size_t part) const
{
  const std::size_t begin = part * part_rows;
  loops_.merge(structure_.shared.data() + begin,
               std::min(part_rows, structure_.shared.size() - begin),
               structure_.shared_ends.data() + 1 + begin, structure_.shared_rows.data(),
               forward_);
}

std::size_t
LatticePass::copies() const
{
  return reverse_ ? partsOf(structure_.vertices) : 0;
}

void
LatticePass::copy(std::size_t part) const
{
  const std::size_t begin = part * part_rows;
  const std::size_t end = std::min(begin + part_rows, structure_.vertices);
  std::copy(forward_ + begin * width_, forward_ + end * width_,
            reverse_ + begin * width_);
}

std::size_t
LatticePass::blurs(std::size_t stage) const
{
  if (stage >= stages())
    return 0;
  return structure_.groups[stage].buckets.size() +
         (reverse_ ? structure_.groups[stages() - 1 - stage].buckets.size() : 0);
}

void
LatticePass::blur(std::size_t stage, std::size_t part) const
{
  const std::vector<LatticeBucket>& first = structure_.groups[stage].buckets;
  const bool is_forward = part < first.size();
  const LatticeBucket& bucket =
      is_forward ? first[part]
                 : structure_.groups[stages() - 1 - stage].buckets[part - first.size()];
  const std::size_t directions = bucket.begins.size();
  for (std::size_t j = 0; j < directions; ++j) {
    const std::size_t direction = is_forward ? j : directions - 1 - j;
    loops_.blur(bucket.steps.data() + bucket.begins[direction],
                bucket.counts[direction], is_forward ? forward_ : reverse_);
  }
}

constexpr std::size_t widest = 16; // rows that are filtered at a time
// Below this number of rows, threading costs more than it saves.
constexpr std::size_t few_rows = 2000;

using Passes = std::vector<std::unique_ptr<LatticePass>>;

// Parts of all passes one after the other, for threads to share.
template <typename CountOf, typename Work>
void
forEachPart(const Passes& passes, bool by_threads, CountOf&& count_of, Work&& work)
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
  forEachPart(
      passes, by_threads, [](const LatticePass& pass) { return pass.merges(); },
      [](const LatticePass& pass, std::size_t part) { pass.merge(part); });
  forEachPart(
      passes, by_threads, [](const LatticePass& pass) { return pass.copies(); },
      [](const LatticePass& pass, std::size_t part) { pass.copy(part); });
  std::size_t stages = 0;
  for (const auto& pass : passes)
    stages = std::max(stages, pass->stages());
  for (std::size_t s = 0; s < stages; ++s)
    forEachPart(
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
