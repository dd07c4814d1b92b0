// SPDX-License-Identifier: BSD-3-Clause
#include "negative_logs.h"
#include "core/simd_choice.h"

#include <cmath>

#define HWY_TARGET_INCLUDE "filters/kernels/negative_logs.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

// a b + c, rounded twice
template <typename V>
HWY_INLINE V
mulAdd(V a, V b, V c)
{
  return hn::Add(hn::Mul(a, b), c);
}

template <typename D>
HWY_INLINE hn::Vec<D>
logOf(D d, hn::Vec<D> value)
{
  const hn::RebindToSigned<D> di;
  const auto set = [&](float number) HWY_ATTR { return hn::Set(d, number); };
  // value = x 2^e with x in [sqrt(1/2), sqrt(2)), then log(1 + x) around 0
  const auto bits = hn::BitCast(di, value);
  auto e = hn::ConvertTo(d, hn::Sub(hn::ShiftRight<23>(bits), hn::Set(di, 126)));
  auto x = hn::BitCast(
      d, hn::Or(hn::And(bits, hn::Set(di, 0x007FFFFF)), hn::Set(di, 0x3F000000)));
  const auto is_low = hn::Lt(x, set(0.707106781186547524f));
  e = hn::Sub(e, hn::IfThenElseZero(is_low, set(1.0f)));
  x = hn::Add(hn::Sub(x, set(1.0f)), hn::IfThenElseZero(is_low, x));
  const auto x2 = hn::Mul(x, x), x3 = hn::Mul(x2, x);
  auto y = mulAdd(set(7.0376836292e-2f), x, set(-1.1514610310e-1f));
  auto y1 = mulAdd(set(-1.2420140846e-1f), x, set(1.4249322787e-1f));
  auto y2 = mulAdd(set(2.0000714765e-1f), x, set(-2.4999993993e-1f));
  y = mulAdd(y, x, set(1.1676998740e-1f));
  y1 = mulAdd(y1, x, set(-1.6668057665e-1f));
  y2 = mulAdd(y2, x, set(3.3333331174e-1f));
  y = hn::Mul(mulAdd(mulAdd(y, x3, y1), x3, y2), x3);
  x = hn::Add(x, mulAdd(set(-0.5f), x2, y));
  return mulAdd(e, set(0.693147180559945309f), x);
}

template <typename D>
HWY_INLINE std::size_t
negateLogsOf(D d, float* values, std::size_t begin, std::size_t count, float smallest)
{
  std::size_t i = begin;
  for (; i + hn::MaxLanes(d) <= count; i += hn::MaxLanes(d)) {
    const auto value = hn::Max(hn::LoadU(d, values + i), hn::Set(d, smallest));
    hn::StoreU(hn::Neg(logOf(d, value)), d, values + i);
  }
  return i;
}

void
negateLogs(float* values, std::size_t count, float smallest)
{
  const hn::CappedTag<float, 16> d;
  std::size_t i = negateLogsOf(d, values, 0, count, smallest);
  i = negateLogsOf(hn::FixedTag<float, 4>(), values, i, count, smallest);
  for (; i < count; ++i)
    values[i] = -::logf(values[i] < smallest ? smallest : values[i]);
}

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

NegativeLogs
negativeLogs(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, negateLogs);
}

} // namespace pcl_semantic::kernels
#endif
