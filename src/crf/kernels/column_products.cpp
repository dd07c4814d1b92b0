// SPDX-License-Identifier: BSD-3-Clause
#include "column_products.h"

#include "core/simd_choice.h"
#include "fetch_ahead.h"

#define HWY_TARGET_INCLUDE "crf/kernels/column_products.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The value where a factor is zero, 0 elsewhere.
template <typename D>
HWY_INLINE hn::Vec<D>
whereZero(D d, hn::Vec<D> factor, float value)
{
  return hn::IfThenElseZero(hn::Eq(factor, hn::Zero(d)), hn::Set(d, value));
}

// Rows that are multiplied at once: 8 or 16.
template <std::size_t Rows>
HWY_INLINE void
multiplyOf(const std::int32_t* indices, std::size_t count, std::size_t readable,
           const float* columns, std::size_t stride, double* product)
{
  const hn::CappedTag<double, Rows> d;
  const hn::Rebind<float, decltype(d)> df;
  const hn::RebindToSigned<decltype(d)> di;
  const auto least = hn::BitCast(di, hn::Set(d, 1e-200));
  constexpr std::size_t lanes = hn::MaxLanes(d), parts = Rows / lanes;
  for (std::size_t l = 0; l < stride; l += Rows) {
    hn::Vec<decltype(d)> part[parts];
    hn::Vec<decltype(df)> zeros[parts];
    for (std::size_t k = 0; k < parts; ++k) {
      part[k] = hn::Set(d, 1.0);
      zeros[k] = hn::Zero(df);
    }
    for (std::size_t e = 0; e < count; ++e) {
      const float* const column = columns + std::size_t(indices[e]) * stride + l;
      fetchAhead(indices, e, readable, columns + l, stride);
      for (std::size_t k = 0; k < parts; ++k) {
        const auto factor = hn::LoadU(df, column + k * lanes);
        const auto one = whereZero(df, factor, 1.0f);
        zeros[k] = hn::Add(zeros[k], one);
        part[k] = hn::Mul(part[k], hn::PromoteTo(d, hn::Add(factor, one)));
        // What is below becomes zero, in integers: the next factor waits for it, and
        // masks of AVX-512 come late.
        const auto less = hn::Sub(least, hn::BitCast(di, part[k]));
        part[k] = hn::And(part[k], hn::BitCast(d, hn::BroadcastSignBit(less)));
      }
    }
    for (std::size_t k = 0; k < parts; ++k) {
      const auto n = hn::PromoteTo(d, zeros[k]);
      const auto one = hn::IfThenElseZero(hn::Eq(n, hn::Set(d, 1.0)), hn::Neg(part[k]));
      hn::StoreU(hn::IfThenElse(hn::Eq(n, hn::Zero(d)), part[k], one), d,
                 product + l + k * lanes);
    }
  }
}

void
multiply(const std::int32_t* indices, std::size_t count, std::size_t readable,
         const float* columns, std::size_t stride, double* product)
{
  if (stride == 8)
    multiplyOf<8>(indices, count, readable, columns, 8, product);
  else
    multiplyOf<16>(indices, count, readable, columns, stride, product);
}

void
addWithout(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
           const double* products, const float* factors, std::size_t stride,
           float* result)
{
  const hn::CappedTag<double, 8> d;
  const hn::Rebind<float, decltype(d)> df;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t l = 0; l < stride; l += hn::MaxLanes(d)) {
      const auto factor = hn::LoadU(df, factors + r * stride + l);
      const auto divisor =
          hn::PromoteTo(d, hn::Add(factor, whereZero(df, factor, -1.0f)));
      auto sum = hn::LoadU(df, result + r * stride + l);
      const std::size_t end = starts[r + 1];
      for (std::size_t e = starts[r]; e < end; ++e) {
        const double* const product = products + std::size_t(indices[e]) * stride + l;
        const auto without = hn::Div(hn::LoadU(d, product), divisor);
        // Negative: a zero is among the other factors.
        const auto negative = hn::Le(without, hn::Zero(d));
        sum = hn::Add(sum, hn::DemoteTo(df, hn::IfThenZeroElse(negative, without)));
      }
      hn::StoreU(sum, df, result + r * stride + l);
    }
}

constexpr ColumnProducts loops{multiply, addWithout};

} // namespace

} // namespace pcl_semantic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic {

const ColumnProducts&
columnProductsFor(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

const ColumnProducts&
columnProducts()
{
  static const ColumnProducts& products = columnProductsFor(simdTier());
  return products;
}

} // namespace pcl_semantic
#endif
