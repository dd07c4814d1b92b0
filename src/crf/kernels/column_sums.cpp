/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "column_sums.h"

#include "lanes.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic {

namespace {

template <std::size_t Lanes>
PCL_SEMANTIC_INLINE void
addBody(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
        const float* __restrict columns, std::size_t stride, float* __restrict result)
{
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t e = starts[r]; e < starts[r + 1]; ++e) {
      const float* const column = columns + std::size_t(indices[e]) * stride;
      float* const sum = result + r * stride;
      for (std::size_t l = 0; l < stride; l += Lanes)
#pragma GCC unroll 1
        for (std::size_t k = 0; k < Lanes; ++k)
          sum[l + k] += column[l + k];
    }
}

template <std::size_t Lanes>
PCL_SEMANTIC_INLINE void
sumBody(const std::int32_t* indices, std::size_t count, std::size_t readable,
        const float* __restrict columns, std::size_t stride, double* __restrict sum)
{
  for (std::size_t l = 0; l < stride; l += Lanes) {
    alignas(64) double part[Lanes] = {};
    for (std::size_t e = 0; e < count; ++e) {
      const float* const column = columns + std::size_t(indices[e]) * stride + l;
      fetchAhead(indices, e, readable, columns + l, stride);
#pragma GCC unroll 1
      for (std::size_t k = 0; k < Lanes; ++k)
        part[k] += double(column[k]);
    }
#pragma GCC unroll 1
    for (std::size_t k = 0; k < Lanes; ++k)
      sum[l + k] = part[k];
  }
}

void
addPlain(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
         const float* columns, std::size_t stride, float* result)
{
  addBody<4>(starts, indices, rows, columns, stride, result);
}

PCL_SEMANTIC_AVX2 void
addAvx2(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
        const float* columns, std::size_t stride, float* result)
{
  addBody<8>(starts, indices, rows, columns, stride, result);
}

PCL_SEMANTIC_AVX512 void
addAvx512(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
          const float* columns, std::size_t stride, float* result)
{
  if (stride == 8)
    addBody<8>(starts, indices, rows, columns, 8, result);
  else
    addBody<16>(starts, indices, rows, columns, stride, result);
}

void
sumPlain(const std::int32_t* indices, std::size_t count, std::size_t readable,
         const float* columns, std::size_t stride, double* sum)
{
  sumBody<4>(indices, count, readable, columns, stride, sum);
}

PCL_SEMANTIC_AVX2 void
sumAvx2(const std::int32_t* indices, std::size_t count, std::size_t readable,
        const float* columns, std::size_t stride, double* sum)
{
  sumBody<8>(indices, count, readable, columns, stride, sum);
}

PCL_SEMANTIC_AVX512 void
sumAvx512(const std::int32_t* indices, std::size_t count, std::size_t readable,
          const float* columns, std::size_t stride, double* sum)
{
  if (stride == 8)
    sumBody<8>(indices, count, readable, columns, 8, sum);
  else
    sumBody<16>(indices, count, readable, columns, stride, sum);
}

constexpr ColumnSums plain{addPlain, sumPlain};
constexpr ColumnSums avx2{addAvx2, sumAvx2};
constexpr ColumnSums avx512{addAvx512, sumAvx512};

} // namespace

const ColumnSums&
columnSumsFor(SimdTier tier)
{
  return ofTier(tier, plain, avx2, avx512);
}

const ColumnSums&
columnSums()
{
  static const ColumnSums& sums = columnSumsFor(simdTier());
  return sums;
}

} // namespace pcl_semantic
