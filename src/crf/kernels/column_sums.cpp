// SPDX-License-Identifier: BSD-3-Clause
#include "column_sums.h"

#include "core/simd_choice.h"
#include "fetch_ahead.h"

#define HWY_TARGET_INCLUDE "crf/kernels/column_sums.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Rows that are summed at once: 8 or 16.
template <std::size_t Rows>
HWY_INLINE void
addOf(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
      const float* columns, std::size_t stride, float* result)
{
  const hn::CappedTag<float, Rows> d;
  for (std::size_t r = 0; r < rows; ++r) {
    float* const sum = result + r * stride;
    const std::size_t end = starts[r + 1];
    for (std::size_t e = starts[r]; e < end; ++e) {
      const float* const column = columns + std::size_t(indices[e]) * stride;
      for (std::size_t l = 0; l < stride; l += Rows)
        for (std::size_t k = l; k < l + Rows; k += hn::MaxLanes(d))
          hn::StoreU(hn::Add(hn::LoadU(d, sum + k), hn::LoadU(d, column + k)), d,
                     sum + k);
    }
  }
}

template <std::size_t Rows>
HWY_INLINE void
sumOf(const std::int32_t* indices, std::size_t count, std::size_t readable,
      const float* columns, std::size_t stride, double* sum)
{
  const hn::CappedTag<double, Rows> d;
  const hn::Rebind<float, decltype(d)> df;
  constexpr std::size_t lanes = hn::MaxLanes(d);
  for (std::size_t l = 0; l < stride; l += Rows) {
    hn::Vec<decltype(d)> parts[Rows / lanes];
    for (auto& part : parts)
      part = hn::Zero(d);
    for (std::size_t e = 0; e < count; ++e) {
      const float* column = columns + std::size_t(indices[e]) * stride + l;
      fetchAhead(indices, e, readable, columns + l, stride);
      for (auto& part : parts) {
        part = hn::Add(part, hn::PromoteTo(d, hn::LoadU(df, column)));
        column += lanes;
      }
    }
    for (std::size_t k = 0; k < Rows / lanes; ++k)
      hn::StoreU(parts[k], d, sum + l + k * lanes);
  }
}

void
add(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
    const float* columns, std::size_t stride, float* result)
{
  if (stride == 8)
    addOf<8>(starts, indices, rows, columns, 8, result);
  else if (stride == 16)
    addOf<16>(starts, indices, rows, columns, 16, result);
  else
    addOf<16>(starts, indices, rows, columns, stride, result);
}

void
sum(const std::int32_t* indices, std::size_t count, std::size_t readable,
    const float* columns, std::size_t stride, double* sums)
{
  if (stride == 8)
    sumOf<8>(indices, count, readable, columns, 8, sums);
  else
    sumOf<16>(indices, count, readable, columns, stride, sums);
}

constexpr ColumnSums loops{add, sum};

} // namespace

} // namespace pcl_semantic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic {

const ColumnSums&
columnSumsFor(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

const ColumnSums&
columnSums()
{
  static const ColumnSums& sums = columnSumsFor(simdTier());
  return sums;
}

} // namespace pcl_semantic
#endif
