/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, with PCL_SEMANTIC_TARGET its instruction set.

#define PCL_SEMANTIC_INLINE PCL_SEMANTIC_TARGET inline __attribute__((always_inline))

typedef char Bytes __attribute__((vector_size(16)));
typedef long long Longs __attribute__((vector_size(16)));
typedef int Ints __attribute__((vector_size(16)));
typedef short Shorts __attribute__((vector_size(16)));

constexpr Ints even_lanes = {0, 2, 4, 6};
constexpr Ints odd_lanes = {1, 3, 5, 7};

PCL_SEMANTIC_INLINE Bytes
loadBytes(const std::uint8_t* from)
{
  Bytes bytes;
  __builtin_memcpy(&bytes, from, sizeof bytes);
  return bytes;
}

/** \brief L1 distance in two halves. */
PCL_SEMANTIC_INLINE Ints
halfDistances(const Bytes* own, const std::uint8_t* other)
{
  Longs sum = __builtin_ia32_psadbw128(own[0], loadBytes(other));
  for (int part = 1; part < descriptor_parts; ++part)
    sum += __builtin_ia32_psadbw128(own[part], loadBytes(other + 16 * part));
  return (Ints)sum;
}

PCL_SEMANTIC_INLINE Ints
fourDistances(const Bytes* own, const std::uint8_t* others)
{
  const Ints a = halfDistances(own, others);
  const Ints b = halfDistances(own, others + descriptor_bytes);
  const Ints c = halfDistances(own, others + 2 * descriptor_bytes);
  const Ints d = halfDistances(own, others + 3 * descriptor_bytes);
  const Ints ab = __builtin_shuffle(a, b, even_lanes);
  const Ints cd = __builtin_shuffle(c, d, even_lanes);
  return __builtin_shuffle(ab, cd, even_lanes) + __builtin_shuffle(ab, cd, odd_lanes);
}

/** \brief Distances to the eight descriptors one after the other at \a others. */
PCL_SEMANTIC_INLINE Shorts
eightDistances(const Bytes* own, const std::uint8_t* others)
{
  return __builtin_ia32_packssdw128(fourDistances(own, others),
                                    fourDistances(own, others + 4 * descriptor_bytes));
}
