// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_pass.h"

#include <algorithm>

namespace pcl_semantic {

namespace {

constexpr std::size_t part_rows = 1024; // that a thread takes at a time

std::size_t
partsOf(std::size_t rows)
{
  return (rows + part_rows - 1) / part_rows;
}

} // namespace

LatticeMemory::Values
LatticeMemory::borrow(std::size_t size)
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

} // namespace pcl_semantic
