// SPDX-License-Identifier: BSD-3-Clause
#include "label_mix.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/label_mix.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Columns that are next to each other: what is read of the matrix serves them all.
template <std::size_t Columns, typename D>
HWY_INLINE void
mixColumns(D d, const float* matrix, std::size_t labels, float* columns,
           std::size_t stride)
{
  float heard[Columns * 256];
  for (std::size_t k = 0; k < Columns * stride; k += hn::MaxLanes(d))
    hn::StoreU(hn::LoadU(d, columns + k), d, heard + k);
  for (std::size_t l = 0; l < stride; l += hn::MaxLanes(d)) {
    hn::Vec<D> sums[Columns];
    for (auto& sum : sums)
      sum = hn::Zero(d);
    for (std::size_t k = 0; k < labels; ++k) {
      const auto costs = hn::LoadU(d, matrix + k * stride + l);
      for (std::size_t c = 0; c < Columns; ++c)
        sums[c] = hn::Sub(sums[c], hn::Mul(costs, hn::Set(d, heard[c * stride + k])));
    }
    for (std::size_t c = 0; c < Columns; ++c)
      hn::StoreU(sums[c], d, columns + c * stride + l);
  }
}

template <std::size_t Rows>
HWY_INLINE void
mixOf(const float* matrix, std::size_t labels, float* columns, std::size_t count,
      std::size_t stride)
{
  const hn::CappedTag<float, Rows> d;
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4)
    mixColumns<4>(d, matrix, labels, columns + i * stride, stride);
  for (; i < count; ++i)
    mixColumns<1>(d, matrix, labels, columns + i * stride, stride);
}

void
mix(const float* matrix, std::size_t labels, float* columns, std::size_t count,
    std::size_t stride)
{
  if (stride == 8)
    mixOf<8>(matrix, labels, columns, count, 8);
  else if (stride == 16)
    mixOf<16>(matrix, labels, columns, count, 16);
  else
    mixOf<16>(matrix, labels, columns, count, stride);
}

} // namespace

} // namespace pcl_semantic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic {

LabelMix
labelMixFor(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, mix);
}

void
mixLabels(const float* matrix, std::size_t labels, float* columns, std::size_t count,
          std::size_t stride)
{
  static const LabelMix function = labelMixFor(simdTier());
  function(matrix, labels, columns, count, stride);
}

} // namespace pcl_semantic
#endif
