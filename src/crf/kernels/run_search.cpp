// SPDX-License-Identifier: BSD-3-Clause
#include "run_search.h"
#include "core/simd_choice.h"

#define HWY_TARGET_INCLUDE "crf/kernels/run_search.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

namespace hn = hwy::HWY_NAMESPACE;

std::size_t
search(const NearRowsView& rows, std::int32_t first, std::int32_t last,
       std::uint32_t* runs)
{
  const hn::CappedTag<std::int32_t, 16> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const auto* const table = reinterpret_cast<const std::int32_t*>(rows.starts);
  std::size_t found = 0;
  for (std::size_t r = 0; r < rows.count; r += hn::Lanes(d)) {
    const auto starts = hn::LoadU(d, rows.first_starts + r);
    const auto cells = hn::LoadU(d, rows.cells + r);
    const auto width = hn::LoadU(d, rows.widths + r);
    const auto begin = hn::LoadU(d, rows.first_cells + r);
    // Of the row: before a cell, or before its end.
    const auto pointsBefore = [&](auto cell) HWY_ATTR {
      const auto inside = hn::Max(hn::Zero(d), hn::Min(cells, cell));
      return hn::GatherIndex(d, table, hn::Add(starts, inside));
    };
    const auto point = pointsBefore(hn::Sub(hn::Sub(hn::Set(d, first), begin), width));
    const auto end = pointsBefore(hn::Add(hn::Sub(hn::Set(d, last + 1), begin), width));
    const auto length = hn::Sub(end, point);
    if (!hn::AllFalse(d, hn::Gt(length, hn::Set(d, longest_run))))
      return run_too_long;
    const auto packed =
        hn::BitCast(du, hn::Or(hn::ShiftLeft<run_length_bits>(point), length));
    if (HWY_TARGET == HWY_AVX3) { // else GCC copies a large table for it each time
      const auto some = hn::Gt(length, hn::Zero(d));
      hn::StoreU(hn::Compress(packed, hn::RebindMask(du, some)), du, runs + found);
      found += hn::CountTrue(d, some);
      continue;
    }
    HWY_ALIGN std::uint32_t stored[hn::MaxLanes(d)];
    hn::Store(packed, du, stored);
    for (const std::uint32_t run : stored) {
      runs[found] = run;
      found += (run & run_length_mask) > 0;
    }
  }
  return found;
}

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

RunSearch
runSearch(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, search);
}

} // namespace pcl_semantic::kernels
#endif
