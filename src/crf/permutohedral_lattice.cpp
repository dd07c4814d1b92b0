// SPDX-License-Identifier: BSD-3-Clause
#include "permutohedral_lattice.h"
#include "kernels/lattice_filter.h"

#include <algorithm>
#include <cmath>

namespace pcl_semantic {

namespace {

constexpr std::size_t widest = 16;      // rows that are filtered at a time
constexpr std::size_t part_rows = 1024; // that a thread takes at a time
// Below this number of rows, threading costs more than it saves.
constexpr std::size_t few_rows = 2000;

// Floats of a row for a number of rows of interest.
std::size_t
widthFor(std::size_t rows)
{
  return rows > 8 ? 16 : rows > 4 ? 8 : rows > 1 ? 4 : 1;
}

std::size_t
partsOf(std::size_t rows)
{
  return (rows + part_rows - 1) / part_rows;
}

/** \brief The way of up to 16 rows of values over a lattice: every step in parts that
 * threads share. */
class LatticePass {
public:
  /** \param[in] values 2 x structure.rows x width floats */
  LatticePass(const LatticeStructure& structure, const kernels::LatticeColumns& columns,
              std::size_t width, SimdTier tier, float* values)
      : structure_(structure), columns_(columns), width_(width),
        loops_(kernels::latticeFilter(tier, width)), forward_(values),
        reverse_(values + structure.rows * width)
  {}

  void
  run() const
  {
    const std::size_t chunks = structure_.chunks(), stages = structure_.groups.size();
    forEach(chunks,
            [&](std::size_t c) { loops_.splat(points(c), columns_, forward_); });
    forEach(partsOf(structure_.shared.size()), [&](std::size_t p) { merge(p); });
    forEach(partsOf(structure_.vertices), [&](std::size_t p) { copy(p); });
    for (std::size_t s = 0; s < stages; ++s) {
      const std::vector<LatticeBucket>& first = structure_.groups[s].buckets;
      const std::vector<LatticeBucket>& last =
          structure_.groups[stages - 1 - s].buckets;
      forEach(first.size() + last.size(), [&](std::size_t b) {
        if (b < first.size())
          blur(first[b]);
        else
          blurInReverse(last[b - first.size()]);
      });
    }
    forEach(chunks, [&](std::size_t c) {
      loops_.slice(points(c), columns_, forward_,
                   static_cast<std::size_t>(reverse_ - forward_));
    });
  }

private:
  template <typename Work>
  void
  forEach(std::size_t parts, Work&& work) const
  {
    const bool by_threads = structure_.rows + structure_.points > few_rows;
#pragma omp parallel for schedule(dynamic, 1) if (by_threads)
    for (std::size_t i = 0; i < parts; ++i)
      work(i);
  }

  kernels::LatticePoints
  points(std::size_t chunk) const
  {
    const std::size_t begin = chunk * structure_.chunk_points;
    const std::size_t partial = structure_.first_partials[chunk];
    return {std::min(structure_.chunk_points, structure_.points - begin),
            structure_.corners,
            structure_.columns.data() + begin,
            structure_.corner_rows.data() + begin * structure_.corners,
            structure_.weights.data() + begin * structure_.corners,
            structure_.row_ends.data() + begin / kernels::row_end_points,
            structure_.first_rows[chunk],
            structure_.vertices + partial,
            structure_.first_partials[chunk + 1] - partial,
            structure_.represents.data() + partial};
  }

  void
  merge(std::size_t part) const
  {
    const std::size_t begin = part * part_rows;
    loops_.merge(structure_.shared.data() + begin,
                 std::min(part_rows, structure_.shared.size() - begin),
                 structure_.shared_ends.data() + 1 + begin,
                 structure_.shared_rows.data(), forward_);
  }

  void
  copy(std::size_t part) const
  {
    const std::size_t begin = part * part_rows;
    const std::size_t end = std::min(begin + part_rows, structure_.vertices);
    std::copy(forward_ + begin * width_, forward_ + end * width_,
              reverse_ + begin * width_);
  }

  void
  blur(const LatticeBucket& bucket) const
  {
    for (std::size_t j = 0; j < bucket.begins.size(); ++j)
      loops_.blur(bucket.steps.data() + bucket.begins[j], bucket.counts[j], forward_);
  }

  void
  blurInReverse(const LatticeBucket& bucket) const
  {
    for (std::size_t j = bucket.begins.size(); j-- > 0;)
      loops_.blur(bucket.steps.data() + bucket.begins[j], bucket.counts[j], reverse_);
  }

  const LatticeStructure& structure_;
  const kernels::LatticeColumns columns_;
  const std::size_t width_;
  const kernels::LatticeFilter& loops_;
  float* forward_; // blurred in the order of directions
  float* reverse_; // blurred in the reverse order
};

} // namespace

Eigen::VectorXd
PermutohedralLattice::origin() const
{
  return Eigen::Map<const Eigen::VectorXd>(structure_.frame.low,
                                           structure_.frame.dimensions);
}

float
PermutohedralLattice::gain() const
{
  // The taps sum to 2 in each of d + 1 directions; a vertex stands for the volume
  // (3/2)^(d/2) / (d + 1)^(1/2) of the space of features.
  const auto corners = double(structure_.corners);
  const double pi = 3.14159265358979323846;
  return float(std::pow(4.0 * pi / 3.0, (corners - 1.0) / 2.0) * std::sqrt(corners) /
               std::exp2(corners));
}

PermutohedralLattice::Values
PermutohedralLattice::borrowValues(std::size_t size) const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  while (!spare_.empty()) {
    Values values = std::move(spare_.back());
    spare_.pop_back();
    if (values->size() >= size)
      return values;
  }
  return std::make_unique<AlignedArray<float>>(size);
}

void
PermutohedralLattice::addFiltered(const Eigen::Ref<const Eigen::MatrixXf>& values,
                                  const Scales& scales,
                                  Eigen::Ref<Eigen::MatrixXf> result) const
{
  if (values.cols() == 0)
    return;
  const float* const end = values.col(values.cols() - 1).data() + values.rows();
  for (Eigen::Index row = 0; row < values.rows(); row += Eigen::Index(widest)) {
    const std::size_t rows = std::min(widest, std::size_t(values.rows() - row));
    const std::size_t width = widthFor(rows);
    const kernels::LatticeColumns columns = {values.data() + row,
                                             end,
                                             std::size_t(values.outerStride()),
                                             result.data() + row,
                                             std::size_t(result.outerStride()),
                                             rows,
                                             scales.splat.data(),
                                             scales.slice.data(),
                                             scales.diagonal.data()};
    Values on_lattice = borrowValues(2 * structure_.rows * width);
    LatticePass(structure_, columns, width, tier_, on_lattice->data()).run();
    const std::lock_guard<std::mutex> lock(mutex_);
    spare_.push_back(std::move(on_lattice));
  }
}

} // namespace pcl_semantic
