// SPDX-License-Identifier: BSD-3-Clause
#include "inference_loops.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/inference_loops.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// exp(-a) for a >= 0, 0 from a = 55: 2^n e^r with n = round(-a / ln 2) and |r| <= ln 2
// / 2. (e^r - 1 - r) / r^2 is a minimax polynomial of degree 4 (Remez, relative error
// 3e-9 in total), evaluated in pairs to shorten the dependency chain.
template <typename D>
HWY_INLINE hn::Vec<D>
exponentialOfMinus(D d, hn::Vec<D> a)
{
  const hn::RebindToUnsigned<D> du;
  const auto timesPlus = [d](auto x, float factor, auto y) HWY_ATTR {
    return hn::Add(hn::Mul(x, hn::Set(d, factor)), y);
  };
  // 1.5 * 2^23, so that the last bit counts ones, plus the exponent bias
  const auto rounder = hn::Set(d, 12582912.0f + 127.0f);
  const auto rounded = timesPlus(a, -1.44269504f, rounder);
  const auto n = hn::Sub(rounded, rounder);
  // ln 2 in two parts; the first has so few bits that its products are exact
  const auto r =
      timesPlus(n, 2.12194440e-4f, hn::Sub(hn::Mul(n, hn::Set(d, -0.693359375f)), a));
  const auto square = hn::Mul(r, r);
  const auto low = timesPlus(r, 1.66665207e-1f, hn::Set(d, 4.99999935e-1f));
  const auto high = timesPlus(square, 1.38146133e-3f,
                              timesPlus(r, 8.36870982e-3f, hn::Set(d, 4.16683874e-2f)));
  const auto sum =
      hn::Add(hn::Add(hn::Mul(hn::Add(hn::Mul(high, square), low), square), r),
              hn::Set(d, 1.0f));
  const auto power = hn::BitCast(d, hn::ShiftLeft<23>(hn::BitCast(du, rounded)));
  return hn::IfThenElseZero(hn::Lt(a, hn::Set(d, 55.0f)), hn::Mul(sum, power));
}

struct Larger {
  template <typename V>
  HWY_INLINE V
  operator()(V a, V b) const
  {
    return hn::Max(a, b);
  }
};

struct Sum {
  template <typename V>
  HWY_INLINE V
  operator()(V a, V b) const
  {
    return hn::Add(a, b);
  }
};

// Adds halves of the vector until one value is left: in the same order for any number
// of lanes.
template <typename Join, typename D>
HWY_INLINE float
joinedLanes(D d, hn::Vec<D> v)
{
  const Join join;
  if constexpr (hn::MaxLanes(d) > 4) {
    const hn::Half<D> half;
    return joinedLanes<Join>(half,
                             join(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
  else {
    v = join(v, hn::Shuffle1032(v));
    return hn::GetLane(join(v, hn::Shuffle2301(v)));
  }
}

template <typename Join, typename D, std::size_t Parts>
HWY_INLINE float
joined(D d, hn::Vec<D> (&parts)[Parts])
{
  for (std::size_t half = Parts / 2; half > 0; half /= 2)
    for (std::size_t k = 0; k < half; ++k)
      parts[k] = Join()(parts[k], parts[k + half]);
  return joinedLanes<Join>(d, parts[0]);
}

// Adjacent columns, Rows of each at once, to hide the latency of one column. Three
// passes over the cached columns: largest exponent, exponentials and their sum,
// probabilities.
template <std::size_t Rows, std::size_t Columns>
HWY_INLINE void
softMaxColumns(const float* HWY_RESTRICT cost, float* HWY_RESTRICT message,
               float* HWY_RESTRICT marginal, std::size_t stride)
{
  const hn::CappedTag<float, Rows> d;
  using V = hn::Vec<decltype(d)>;
  constexpr std::size_t Parts = Rows / hn::MaxLanes(d);
  const auto exponent = [&](std::size_t at) HWY_ATTR {
    return hn::Sub(hn::LoadU(d, message + at), hn::LoadU(d, cost + at));
  };
  const auto forAll = [&](std::size_t first, std::size_t end, auto act) HWY_ATTR {
    for (std::size_t l = first; l < end; l += Rows)
      for (std::size_t c = 0; c < Columns; ++c)
        for (std::size_t k = 0; k < Parts; ++k)
          act(c, k, c * stride + l + k * hn::MaxLanes(d));
  };
  V largest[Columns][Parts], sum[Columns][Parts], top[Columns], scale[Columns];
  forAll(0, Rows, [&](std::size_t c, std::size_t k, std::size_t at) HWY_ATTR {
    largest[c][k] = exponent(at);
    sum[c][k] = hn::Zero(d);
  });
  forAll(Rows, stride, [&](std::size_t c, std::size_t k, std::size_t at) HWY_ATTR {
    largest[c][k] = hn::Max(exponent(at), largest[c][k]);
  });
  for (std::size_t c = 0; c < Columns; ++c)
    top[c] = hn::Set(d, joined<Larger>(d, largest[c]));
  forAll(0, stride, [&](std::size_t c, std::size_t k, std::size_t at) HWY_ATTR {
    const auto value = exponentialOfMinus(d, hn::Sub(top[c], exponent(at)));
    hn::StoreU(value, d, message + at);
    sum[c][k] = hn::Add(sum[c][k], value);
  });
  for (std::size_t c = 0; c < Columns; ++c)
    scale[c] = hn::Set(d, 1.0f / joined<Sum>(d, sum[c]));
  forAll(0, stride, [&](std::size_t c, std::size_t, std::size_t at) HWY_ATTR {
    const auto probability = hn::Mul(hn::LoadU(d, message + at), scale[c]);
    hn::StoreU(probability, d, marginal + at);
    hn::StoreU(hn::Zero(d), d, message + at);
  });
}

template <std::size_t Rows>
HWY_INLINE void
softMaxOf(const float* costs, float* messages, float* marginals, std::size_t columns,
          std::size_t stride)
{
  std::size_t i = 0;
  // Four long columns would exceed the processor's prefetch streams.
  for (; stride <= 64 && i + 4 <= columns; i += 4)
    softMaxColumns<Rows, 4>(costs + i * stride, messages + i * stride,
                            marginals + i * stride, stride);
  for (; i < columns; ++i)
    softMaxColumns<Rows, 1>(costs + i * stride, messages + i * stride,
                            marginals + i * stride, stride);
}

void
softMax(const float* costs, float* messages, float* marginals, std::size_t columns,
        std::size_t stride)
{
  if (stride == 8)
    return softMaxOf<8>(costs, messages, marginals, columns, 8);
  if (stride == 16) // one column fits in registers
    return softMaxOf<16>(costs, messages, marginals, columns, 16);
  return softMaxOf<16>(costs, messages, marginals, columns, stride);
}

// Adjacent columns, which share the loads of the matrix.
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
mixLabels(const float* matrix, std::size_t labels, float* columns, std::size_t count,
          std::size_t stride)
{
  if (stride == 8)
    mixOf<8>(matrix, labels, columns, count, 8);
  else if (stride == 16)
    mixOf<16>(matrix, labels, columns, count, 16);
  else
    mixOf<16>(matrix, labels, columns, count, stride);
}

// Prefetch distance for columns of an index list, because members of a clique are
// scattered in memory. Three times as fast as without prefetching.
constexpr std::size_t columns_ahead = 16;

// Prefetches the column at columns_ahead after the e-th readable index.
HWY_INLINE void
fetchAhead(const std::int32_t* indices, std::size_t e, std::size_t readable,
           const float* columns, std::size_t stride)
{
  const std::size_t ahead = e + columns_ahead < readable ? e + columns_ahead : e;
  hwy::Prefetch(columns + std::size_t(indices[ahead]) * stride);
}

// Rows per step: 8 or 16.
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
addColumns(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
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
sumColumns(const std::int32_t* indices, std::size_t count, std::size_t readable,
           const float* columns, std::size_t stride, double* sums)
{
  if (stride == 8)
    sumOf<8>(indices, count, readable, columns, 8, sums);
  else
    sumOf<16>(indices, count, readable, columns, stride, sums);
}

// The value where a factor is zero, otherwise 0.
template <typename D>
HWY_INLINE hn::Vec<D>
whereZero(D d, hn::Vec<D> factor, float value)
{
  return hn::IfThenElseZero(hn::Eq(factor, hn::Zero(d)), hn::Set(d, value));
}

// Rows per step: 8 or 16.
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
        // Smaller factors become zero, by integer operations: the next factor depends
        // on it, and AVX-512 masks have a higher latency.
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
multiplyColumns(const std::int32_t* indices, std::size_t count, std::size_t readable,
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
        // Negative: another factor is zero.
        const auto negative = hn::Le(without, hn::Zero(d));
        sum = hn::Add(sum, hn::DemoteTo(df, hn::IfThenZeroElse(negative, without)));
      }
      hn::StoreU(sum, df, result + r * stride + l);
    }
}

constexpr InferenceLoops loops = {softMax,    mixLabels,       addColumns,
                                  sumColumns, multiplyColumns, addWithout};

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

const InferenceLoops&
inferenceLoops(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, loops);
}

} // namespace pcl_semantic::kernels
#endif
