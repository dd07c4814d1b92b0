// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_kernel.h"
#include "requirements.h"

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t widest = 16; // rows that are filtered at once
// Below this number of rows, threading costs more than it saves.
constexpr std::size_t few_rows = 2000;

/** \brief Filters up to 16 rows of values on a lattice; threads share every step. */
struct LatticePass {
  const PermutohedralLattice& lattice;
  const kernels::LatticeColumns columns;
  const std::size_t width;
  const kernels::LatticeFilter& loops;
  float* const forward; // rows of width floats, blurred in the order of directions
  float* const reverse; // blurred in the reverse order

  void
  run() const
  {
    const std::size_t chunks = lattice.chunks(), stages = lattice.groups.size();
    forEach(chunks, [&](std::size_t c) { loops.splat(points(c), columns, forward); });
    forEach(lattice.merged_begins.size() - 1, [&](std::size_t p) { mergeAndCopy(p); });
    for (std::size_t s = 0; s < stages; ++s) {
      const auto& first = lattice.groups[s].buckets;
      const auto& last = lattice.groups[stages - 1 - s].buckets;
      forEach(first.size() + last.size(), [&](std::size_t b) {
        b < first.size() ? blur(first[b], false) : blur(last[b - first.size()], true);
      });
    }
    forEach(chunks, [&](std::size_t c) {
      loops.slice(points(c), columns, forward, lattice.rows * width);
    });
  }

  template <typename Work>
  void
  forEach(std::size_t parts, Work&& work) const
  {
    const bool by_threads = lattice.rows + lattice.points > few_rows;
#pragma omp parallel for schedule(dynamic, 1) if (by_threads)
    for (std::size_t i = 0; i < parts; ++i)
      work(i);
  }

  kernels::LatticePoints
  points(std::size_t chunk) const
  {
    const std::size_t begin = chunk * lattice.chunk_points;
    const std::size_t row = lattice.first_rows[chunk];
    const std::size_t partial = lattice.first_partials[chunk];
    return {std::min(lattice.chunk_points, lattice.points - begin),
            lattice.corners,
            lattice.columns.data() + begin,
            lattice.corner_rows.data() + begin * lattice.corners,
            lattice.weights.data() + begin * lattice.corners,
            row,
            lattice.first_rows[chunk + 1] - row,
            lattice.vertices + partial,
            lattice.first_partials[chunk + 1] - partial,
            lattice.represents.data() + partial};
  }

  void
  mergeAndCopy(std::size_t part) const
  {
    const std::size_t merged = lattice.merged_begins[part];
    loops.merge(lattice.merged.data() + merged,
                lattice.merged_begins[part + 1] - merged, lattice.represents.data(),
                lattice.vertices, forward);
    const std::size_t begin = part * lattice.part_rows;
    const std::size_t end = std::min(begin + lattice.part_rows, lattice.vertices);
    std::copy(forward + begin * width, forward + end * width, reverse + begin * width);
  }

  void
  blur(const PermutohedralLattice::Bucket& bucket, bool reversed) const
  {
    const std::size_t directions = bucket.begins.size() - 1;
    for (std::size_t k = 0; k < directions; ++k) {
      const std::size_t j = reversed ? directions - 1 - k : k;
      loops.blur(bucket.steps.data() + bucket.begins[j],
                 bucket.begins[j + 1] - bucket.begins[j] - 1,
                 reversed ? reverse : forward);
    }
  }
};

} // namespace

LatticeKernel::LatticeKernel(const Eigen::Ref<const Eigen::MatrixXf>& features,
                             float weight, Normalization normalization, SimdTier tier,
                             const Eigen::VectorXf& lows)
    : lattice_(features, tier, lows), tier_(tier),
      splat_scale_(Eigen::ArrayXf::Ones(size())), slice_scale_(splat_scale_),
      diagonal_(Eigen::ArrayXf::Zero(size()))
{
  requireWeight(weight);
  if (normalization == Normalization::none) {
    slice_scale_ *= weight * lattice_.gain();
  }
  else {
    Eigen::MatrixXf sums = Eigen::MatrixXf::Zero(1, size());
    addProduct(Eigen::MatrixXf::Ones(1, size()), sums);
    slice_scale_ = weight / sums.row(0).transpose().array();
    // Eigen's sqrt() approximates, and gives other bits on other processors.
    if (normalization == Normalization::symmetric)
      splat_scale_ = slice_scale_ =
          slice_scale_.unaryExpr([](float scale) { return std::sqrt(scale); });
  }
  diagonal_ = lattice_.self_responses * slice_scale_ * splat_scale_;
}

void
LatticeKernel::addProduct(const Eigen::Ref<const Eigen::MatrixXf>& values,
                          Eigen::Ref<Eigen::MatrixXf> result) const
{
  if (values.cols() == 0)
    return;
  const float* const end = values.col(values.cols() - 1).data() + values.rows();
  for (Eigen::Index row = 0; row < values.rows(); row += Eigen::Index(widest)) {
    const std::size_t rows = std::min(widest, std::size_t(values.rows() - row));
    const std::size_t width = rows > 8 ? 16 : rows > 4 ? 8 : rows > 1 ? 4 : 1;
    const kernels::LatticeColumns columns = {values.data() + row,
                                             end,
                                             std::size_t(values.outerStride()),
                                             result.data() + row,
                                             std::size_t(result.outerStride()),
                                             rows,
                                             splat_scale_.data(),
                                             slice_scale_.data(),
                                             diagonal_.data()};
    const std::lock_guard<std::mutex> lock(mutex_);
    if (rows_.size() < 2 * lattice_.rows * width)
      rows_ = AlignedArray<float>(2 * lattice_.rows * width);
    LatticePass{lattice_,     columns,
                width,        kernels::latticeFilter(tier_, width),
                rows_.data(), rows_.data() + lattice_.rows * width}
        .run();
  }
}

} // namespace pcl_semantic
