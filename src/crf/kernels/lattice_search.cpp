/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "lattice_search.h"

#include <immintrin.h>

namespace pcl_semantic::kernels {

namespace {

void
searchPlain(const LatticeTableView& table, const std::uint64_t* keys, std::size_t count,
            std::int32_t* numbers)
{
  const LatticeTableView view = table; // numbers may not overwrite it
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t found = view.slots[mixKey(keys[i]) >> view.shift];
    const std::uint32_t number = (found & view.number_mask) - (found != 0 ? 1 : 0);
    const bool is_it = view.keys[number] == keys[i];
    numbers[i] = found == 0 ? -1 : is_it ? std::int32_t(number) : not_first;
  }
}

__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl"))) void
searchAvx512(const LatticeTableView& table, const std::uint64_t* keys,
             std::size_t count, std::int32_t* numbers)
{
  const __m512i first_factor = _mm512_set1_epi64(std::int64_t(key_factors[0]));
  const __m512i second_factor = _mm512_set1_epi64(std::int64_t(key_factors[1]));
  const __m128i shift = _mm_cvtsi32_si128(table.shift);
  const __m256i number_mask = _mm256_set1_epi32(std::int32_t(table.number_mask));
  const __m256i one = _mm256_set1_epi32(1), zero = _mm256_setzero_si256();
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    const __m512i key = _mm512_loadu_si512(keys + i);
    __m512i hash = _mm512_mullo_epi64(key, first_factor);
    hash = _mm512_xor_si512(hash, _mm512_srli_epi64(hash, 32));
    hash = _mm512_mullo_epi64(hash, second_factor);
    const __m256i found =
        _mm512_i64gather_epi32(_mm512_srl_epi64(hash, shift), table.slots, 4);
    const __mmask8 is_taken = _mm256_cmpneq_epi32_mask(found, zero);
    const __m256i number = _mm256_sub_epi32(_mm256_and_si256(found, number_mask), one);
    const __m512i known = _mm512_mask_i32gather_epi64(_mm512_setzero_si512(), is_taken,
                                                      number, table.keys, 8);
    const __mmask8 is_it = _mm512_mask_cmpeq_epi64_mask(is_taken, known, key);
    const __m256i other = _mm256_mask_mov_epi32(_mm256_set1_epi32(-1), is_taken,
                                                _mm256_set1_epi32(not_first));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(numbers + i),
                        _mm256_mask_mov_epi32(other, is_it, number));
  }
  searchPlain(table, keys + i, count - i, numbers + i);
}

} // namespace

LatticeSearch
latticeSearch(SimdTier tier)
{
  return tier == SimdTier::avx512 ? searchAvx512 : searchPlain;
}

} // namespace pcl_semantic::kernels
