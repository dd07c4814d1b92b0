// SPDX-License-Identifier: BSD-3-Clause
#include "soft_max.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/soft_max.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// exp(-a) for a >= 0, 0 from a = 55: 2^n e^r with n = round(-a / ln 2) and
// |r| <= ln 2 / 2. (e^r - 1 - r) / r^2 is the polynomial of degree 4 with the least
// largest error of the whole (3e-9; Remez), in pairs: short ways from r to its end.
template <typename D>
HWY_INLINE hn::Vec<D>
exponentialOfMinus(D d, hn::Vec<D> a)
{
  const hn::RebindToUnsigned<D> du;
  const auto timesPlus = [d](auto x, float factor, auto y) HWY_ATTR {
    return hn::Add(hn::Mul(x, hn::Set(d, factor)), y);
  };
  // 1.5 * 2^23, so that the last bit counts ones, and the offset of an exponent's bits
  const auto rounder = hn::Set(d, 12582912.0f + 127.0f);
  const auto rounded = timesPlus(a, -1.44269504f, rounder);
  const auto n = hn::Sub(rounded, rounder);
  // ln 2 in two parts, the first of so few bits that its products are exact
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

// Halves with each other until one value is left: always in the same order, whatever
// lanes a vector has.
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

// Columns next to each other, Rows of each at once: one column alone would have the
// processor wait for one result after the other. They go through the cache three times:
// largest exponent, exponentials and their sum, probabilities.
template <std::size_t Rows, std::size_t Columns, typename V, std::size_t Parts>
HWY_INLINE void
softMaxColumns(const float* HWY_RESTRICT cost, float* HWY_RESTRICT message,
               float* HWY_RESTRICT marginal, std::size_t stride, V (&changes)[Parts])
{
  const hn::CappedTag<float, Rows> d;
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
  forAll(0, stride, [&](std::size_t c, std::size_t k, std::size_t at) HWY_ATTR {
    const auto probability = hn::Mul(hn::LoadU(d, message + at), scale[c]);
    const auto change = hn::Abs(hn::Sub(probability, hn::LoadU(d, marginal + at)));
    changes[k] = hn::Max(change, changes[k]);
    hn::StoreU(probability, d, marginal + at);
    hn::StoreU(hn::Zero(d), d, message + at);
  });
}

template <std::size_t Rows>
HWY_INLINE float
softMaxOf(const float* costs, float* messages, float* marginals, std::size_t columns,
          std::size_t stride)
{
  const hn::CappedTag<float, Rows> d;
  hn::Vec<decltype(d)> change[Rows / hn::MaxLanes(d)];
  for (auto& part : change)
    part = hn::Zero(d);
  std::size_t i = 0;
  // Four long columns would be more streams than the processor fetches ahead.
  for (; stride <= 64 && i + 4 <= columns; i += 4)
    softMaxColumns<Rows, 4>(costs + i * stride, messages + i * stride,
                            marginals + i * stride, stride, change);
  for (; i < columns; ++i)
    softMaxColumns<Rows, 1>(costs + i * stride, messages + i * stride,
                            marginals + i * stride, stride, change);
  return joined<Larger>(d, change);
}

float
softMaxLoop(const float* costs, float* messages, float* marginals, std::size_t columns,
            std::size_t stride)
{
  if (stride == 8)
    return softMaxOf<8>(costs, messages, marginals, columns, 8);
  if (stride == 16) // nothing goes through memory
    return softMaxOf<16>(costs, messages, marginals, columns, 16);
  return softMaxOf<16>(costs, messages, marginals, columns, stride);
}

} // namespace

} // namespace pcl_semantic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic {

SoftMax
softMaxFor(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, softMaxLoop);
}

float
softMax(const float* costs, float* messages, float* marginals, std::size_t columns,
        std::size_t stride)
{
  static const SoftMax function = softMaxFor(simdTier());
  return function(costs, messages, marginals, columns, stride);
}

} // namespace pcl_semantic
#endif
