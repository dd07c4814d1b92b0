/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "run_search.h"

#include <pcl_semantic/core/simd_choice.h>

#include <immintrin.h>

namespace pcl_semantic::kernels {

namespace {

std::size_t
searchPlain(const NearRowsView& rows, std::int32_t first, std::int32_t last,
            std::uint32_t* runs)
{
  std::size_t found = 0;
  for (std::size_t r = 0; r < rows.count; ++r) {
    const std::uint32_t* const starts = rows.starts + rows.first_starts[r];
    const std::int32_t begin = rows.first_cells[r], cells = rows.cells[r];
    std::int32_t from = first - begin - rows.widths[r];
    std::int32_t to = last - begin + rows.widths[r] + 1;
    from = from < 0 ? 0 : from > cells ? cells : from;
    to = to < 0 ? 0 : to > cells ? cells : to;
    const std::uint32_t point = starts[from], length = starts[to] - point;
    if (length > longest_run)
      return run_too_long;
    runs[found] = point << run_length_bits | length;
    found += length > 0;
  }
  return found;
}

__attribute__((target("avx2"))) inline __m256i
load(const std::int32_t* from)
{
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
}

__attribute__((target("avx2"))) std::size_t
searchAvx2(const NearRowsView& rows, std::int32_t first, std::int32_t last,
           std::uint32_t* runs)
{
  const auto* const table = reinterpret_cast<const int*>(rows.starts);
  const __m256i zero = _mm256_setzero_si256();
  std::size_t found = 0;
  for (std::size_t r = 0; r < rows.count; r += 8) {
    const __m256i starts = load(rows.first_starts + r), cells = load(rows.cells + r);
    const __m256i width = load(rows.widths + r);
    const __m256i begin = load(rows.first_cells + r);
    const __m256i low =
        _mm256_sub_epi32(_mm256_sub_epi32(_mm256_set1_epi32(first), begin), width);
    const __m256i high =
        _mm256_add_epi32(_mm256_sub_epi32(_mm256_set1_epi32(last + 1), begin), width);
    const __m256i from = _mm256_max_epi32(zero, _mm256_min_epi32(cells, low));
    const __m256i to = _mm256_max_epi32(zero, _mm256_min_epi32(cells, high));
    const __m256i point =
        _mm256_i32gather_epi32(table, _mm256_add_epi32(starts, from), 4);
    const __m256i end = _mm256_i32gather_epi32(table, _mm256_add_epi32(starts, to), 4);
    const __m256i length = _mm256_sub_epi32(end, point);
    if (_mm256_movemask_epi8(
            _mm256_cmpgt_epi32(length, _mm256_set1_epi32(int(longest_run)))))
      return run_too_long;
    alignas(32) std::uint32_t packed[8];
    _mm256_store_si256(
        reinterpret_cast<__m256i*>(packed),
        _mm256_or_si256(_mm256_slli_epi32(point, run_length_bits), length));
    for (const std::uint32_t run : packed) {
      runs[found] = run;
      found += (run & run_length_mask) > 0;
    }
  }
  return found;
}

__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl"))) std::size_t
searchAvx512(const NearRowsView& rows, std::int32_t first, std::int32_t last,
             std::uint32_t* runs)
{
  const __m512i zero = _mm512_setzero_si512();
  std::size_t found = 0;
  for (std::size_t r = 0; r < rows.count; r += 16) {
    const __m512i starts = _mm512_loadu_si512(rows.first_starts + r);
    const __m512i cells = _mm512_loadu_si512(rows.cells + r);
    const __m512i width = _mm512_loadu_si512(rows.widths + r);
    const __m512i begin = _mm512_loadu_si512(rows.first_cells + r);
    const __m512i low =
        _mm512_sub_epi32(_mm512_sub_epi32(_mm512_set1_epi32(first), begin), width);
    const __m512i high =
        _mm512_add_epi32(_mm512_sub_epi32(_mm512_set1_epi32(last + 1), begin), width);
    const __m512i from = _mm512_max_epi32(zero, _mm512_min_epi32(cells, low));
    const __m512i to = _mm512_max_epi32(zero, _mm512_min_epi32(cells, high));
    const __m512i point =
        _mm512_i32gather_epi32(_mm512_add_epi32(starts, from), rows.starts, 4);
    const __m512i end =
        _mm512_i32gather_epi32(_mm512_add_epi32(starts, to), rows.starts, 4);
    const __m512i length = _mm512_sub_epi32(end, point);
    if (_mm512_cmpgt_epi32_mask(length, _mm512_set1_epi32(int(longest_run))))
      return run_too_long;
    const __mmask16 some = _mm512_test_epi32_mask(length, length);
    _mm512_storeu_si512(
        runs + found,
        _mm512_maskz_compress_epi32(
            some, _mm512_or_si512(_mm512_slli_epi32(point, run_length_bits), length)));
    found += std::size_t(__builtin_popcount(some));
  }
  return found;
}

} // namespace

RunSearch
runSearch(SimdTier tier)
{
  return ofTier(tier, searchPlain, searchAvx2, searchAvx512);
}

} // namespace pcl_semantic::kernels
