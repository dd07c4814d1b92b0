/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "kernels/lattice_filter.h"
#include "lattice_structure.h"

#include <pcl_semantic/crf/permutohedral_lattice.h>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace pcl_semantic {

namespace {

// To wake threads costs more than to filter fewer rows than that by oneself.
constexpr std::size_t few_rows = 2000;
constexpr std::size_t merge_vertices = 1024; // that a thread takes at a time
constexpr std::size_t widest = 16;           // rows that are filtered at a time

std::size_t
widthFor(Eigen::Index rows)
{
  return rows > 8 ? 16 : rows > 4 ? 8 : rows > 1 ? 4 : 1;
}

} // namespace

class PermutohedralLattice::Implementation {
public:
  Implementation(const LatticeFeatures& features, SimdTier tier)
      : structure(buildLattice(features, tier)), tier_(tier),
        is_large_(structure.rows + structure.points > few_rows)
  {}

  // Filters up to 16 rows.
  void
  filter(const kernels::LatticeColumns& columns, LatticeBlur order)
  {
    const std::size_t width = widthFor(Eigen::Index(columns.rows));
    const std::size_t halves = order == LatticeBlur::symmetric ? 2 : 1;
    const kernels::LatticeFilter& loops = kernels::latticeFilter(tier_, width, halves);
    const std::size_t half = structure.rows * width;
    const Values values = borrow(half * halves);
    float* const lattice = values->data();
#pragma omp parallel for schedule(dynamic, 1) if (is_large_)
    for (std::size_t c = 0; c < structure.chunks(); ++c)
      loops.splat(chunk(c), columns, lattice);
#pragma omp parallel for schedule(dynamic, 1) if (is_large_)
    for (std::size_t m = 0; m < structure.shared.size(); m += merge_vertices)
      loops.merge(structure.shared.data() + m,
                  std::min(merge_vertices, structure.shared.size() - m),
                  structure.shared_ends.data() + 1 + m, structure.shared_rows.data(),
                  lattice);
    if (halves == 2)
      copyRows(lattice, width, lattice + half);
    for (std::size_t g = 0; g < structure.groups.size(); ++g)
      blur(g, loops, lattice, halves == 2 ? lattice + half : nullptr);
#pragma omp parallel for schedule(dynamic, 1) if (is_large_)
    for (std::size_t c = 0; c < structure.chunks(); ++c)
      loops.slice(chunk(c), columns, lattice, half);
    giveBack(values);
  }

  std::size_t
  memory(LatticeBlur order) const
  {
    const std::size_t halves = order == LatticeBlur::symmetric ? 2 : 1;
    return structure.memory() + structure.rows * halves * widest * sizeof(float);
  }

  const LatticeStructure structure;

private:
  using Values = std::shared_ptr<LatticeArray<float>>;

  // Memory is kept from one product to the next: to get it costs more than to fill it.
  Values
  borrow(std::size_t size)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    while (!spare_.empty()) {
      const Values values = spare_.back();
      spare_.pop_back();
      if (values->size() >= size)
        return values;
    }
    return std::make_shared<LatticeArray<float>>(size);
  }

  void
  giveBack(const Values& values)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    spare_.push_back(values);
  }

  kernels::LatticePoints
  chunk(std::size_t c) const
  {
    const std::size_t begin = c * structure.chunk_points;
    const std::size_t partial = structure.first_partials[c];
    return {std::min(structure.chunk_points, structure.points - begin),
            structure.corners,
            structure.columns.data() + begin,
            structure.corner_rows.data() + begin * structure.corners,
            structure.weights.data() + begin * structure.corners,
            structure.row_ends.data() + begin / kernels::row_end_points,
            structure.first_rows[c],
            structure.vertices + partial,
            structure.first_partials[c + 1] - partial,
            structure.represents.data() + partial};
  }

  // The rows of the vertices.
  void
  copyRows(const float* from, std::size_t width, float* to) const
  {
    const std::size_t count = structure.vertices * width;
#pragma omp parallel for schedule(static) if (is_large_)
    for (std::size_t begin = 0; begin < count; begin += merge_vertices * widest)
      std::copy_n(from + begin, std::min(merge_vertices * widest, count - begin),
                  to + begin);
  }

  // A group of one half in the order of directions, and the opposite group of the other
  // half, if there is one, in the reverse order.
  void
  blur(std::size_t g, const kernels::LatticeFilter& loops, float* forward,
       float* reverse) const
  {
    const std::vector<LatticeBucket>& first = structure.groups[g].buckets;
    const std::vector<LatticeBucket>& second =
        structure.groups[structure.groups.size() - 1 - g].buckets;
    const std::size_t count = first.size() + (reverse ? second.size() : 0);
#pragma omp parallel for schedule(dynamic, 1) if (is_large_)
    for (std::size_t b = 0; b < count; ++b) {
      const bool is_first = b < first.size();
      const LatticeBucket& bucket = is_first ? first[b] : second[b - first.size()];
      const std::size_t directions = bucket.begins.size();
      for (std::size_t j = 0; j < directions; ++j) {
        const std::size_t direction = is_first ? j : directions - 1 - j;
        loops.blur(bucket.steps.data() + bucket.begins[direction],
                   bucket.counts[direction], is_first ? forward : reverse);
      }
    }
  }

  SimdTier tier_;
  bool is_large_;
  std::mutex mutex_;
  std::vector<Values> spare_;
};

PermutohedralLattice::PermutohedralLattice(
    const Eigen::Ref<const Eigen::MatrixXf>& features, SimdTier tier)
    : implementation_(std::make_unique<Implementation>(features, tier))
{}

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
                                  const Scales& scales, const VariableMask& active,
                                  Eigen::Ref<Eigen::MatrixXf> result,
                                  LatticeBlur blur) const
{
  if (size() == 0)
    return;
  const float* const end = values.col(values.cols() - 1).data() + values.rows();
  for (Eigen::Index row = 0; row < values.rows(); row += Eigen::Index(widest))
    implementation_->filter(
        {values.data() + row, end, std::size_t(values.outerStride()),
         result.data() + row, std::size_t(result.outerStride()),
         std::min(widest, std::size_t(values.rows() - row)), scales.splat.data(),
         scales.slice.data(), scales.diagonal.data(),
         active.empty() ? nullptr : active.data()},
        blur);
}

std::size_t
PermutohedralLattice::memory(LatticeBlur blur) const
{
  return implementation_->memory(blur);
}

} // namespace pcl_semantic
