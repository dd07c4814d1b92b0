/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include "column_products.h"

#include "lanes.h"

#include <pcl_semantic/core/simd_choice.h>

namespace pcl_semantic {

namespace {

PCL_SEMANTIC_INLINE std::int64_t
bitsOf(double value)
{
  return __builtin_bit_cast(std::int64_t, value);
}

// The value where the mask is -1, 0 where it is 0. Masks instead of conditions:
// compilers make branches of those.
PCL_SEMANTIC_INLINE double
masked(double value, std::int64_t mask)
{
  return __builtin_bit_cast(double, bitsOf(value) & mask);
}

// -1 if a value that is not negative is zero, else 0.
PCL_SEMANTIC_INLINE std::int64_t
isZero(double value)
{
  return (bitsOf(value) - 1) >> 63;
}

template <std::size_t Lanes>
PCL_SEMANTIC_INLINE void
multiplyBody(const std::int32_t* indices, std::size_t count, std::size_t readable,
             const float* __restrict columns, std::size_t stride,
             double* __restrict product)
{
  for (std::size_t l = 0; l < stride; l += Lanes) {
    alignas(64) double part[Lanes];
    alignas(64) double zeros[Lanes] = {};
#pragma GCC unroll 1
    for (std::size_t k = 0; k < Lanes; ++k)
      part[k] = 1.0;
    for (std::size_t e = 0; e < count; ++e) {
      const float* const column = columns + std::size_t(indices[e]) * stride + l;
      fetchAhead(indices, e, readable, columns + l, stride);
#pragma GCC unroll 1
      for (std::size_t k = 0; k < Lanes; ++k) {
        const double factor = double(column[k]);
        const double one = masked(1.0, isZero(factor)); // in place of a zero
        zeros[k] += one;
        part[k] *= factor + one;
        part[k] = masked(part[k], (bitsOf(1e-200) - bitsOf(part[k])) >> 63);
      }
    }
#pragma GCC unroll 1
    for (std::size_t k = 0; k < Lanes; ++k) {
      const double sign = zeros[k] == 0.0 ? 1.0 : -1.0;
      product[l + k] = zeros[k] < 1.5 ? sign * part[k] : 0.0;
    }
  }
}

template <std::size_t Lanes>
PCL_SEMANTIC_INLINE void
addWithoutBody(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
               const double* __restrict products, const float* __restrict factors,
               std::size_t stride, float* __restrict result)
{
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t e = starts[r]; e < starts[r + 1]; ++e) {
      const double* const product = products + std::size_t(indices[e]) * stride;
      for (std::size_t l = 0; l < stride; l += Lanes)
#pragma GCC unroll 1
        for (std::size_t k = 0; k < Lanes; ++k) {
          const double factor = double(factors[r * stride + l + k]);
          const std::int64_t zero = isZero(factor);
          const double divisor = factor + masked(-1.0, zero);
          const double without = product[l + k] / divisor;
          // Negative: a zero is among the other factors.
          result[r * stride + l + k] +=
              float(masked(without, ~(bitsOf(without) >> 63)));
        }
    }
}

void
multiplyPlain(const std::int32_t* indices, std::size_t count, std::size_t readable,
              const float* columns, std::size_t stride, double* product)
{
  multiplyBody<2>(indices, count, readable, columns, stride, product);
}

PCL_SEMANTIC_AVX2 void
multiplyAvx2(const std::int32_t* indices, std::size_t count, std::size_t readable,
             const float* columns, std::size_t stride, double* product)
{
  multiplyBody<4>(indices, count, readable, columns, stride, product);
}

PCL_SEMANTIC_AVX512 void
multiplyAvx512(const std::int32_t* indices, std::size_t count, std::size_t readable,
               const float* columns, std::size_t stride, double* product)
{
  multiplyBody<8>(indices, count, readable, columns, stride, product);
}

void
addWithoutPlain(const std::size_t* starts, const std::int32_t* indices,
                std::size_t rows, const double* products, const float* factors,
                std::size_t stride, float* result)
{
  addWithoutBody<2>(starts, indices, rows, products, factors, stride, result);
}

PCL_SEMANTIC_AVX2 void
addWithoutAvx2(const std::size_t* starts, const std::int32_t* indices, std::size_t rows,
               const double* products, const float* factors, std::size_t stride,
               float* result)
{
  addWithoutBody<4>(starts, indices, rows, products, factors, stride, result);
}

PCL_SEMANTIC_AVX512 void
addWithoutAvx512(const std::size_t* starts, const std::int32_t* indices,
                 std::size_t rows, const double* products, const float* factors,
                 std::size_t stride, float* result)
{
  addWithoutBody<8>(starts, indices, rows, products, factors, stride, result);
}

constexpr ColumnProducts plain{multiplyPlain, addWithoutPlain};
constexpr ColumnProducts avx2{multiplyAvx2, addWithoutAvx2};
constexpr ColumnProducts avx512{multiplyAvx512, addWithoutAvx512};

} // namespace

const ColumnProducts&
columnProductsFor(SimdTier tier)
{
  return ofTier(tier, plain, avx2, avx512);
}

const ColumnProducts&
columnProducts()
{
  static const ColumnProducts& products = columnProductsFor(simdTier());
  return products;
}

} // namespace pcl_semantic
