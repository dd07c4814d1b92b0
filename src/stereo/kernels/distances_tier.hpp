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

#ifdef PCL_SEMANTIC_WIDE

typedef char WideBytes __attribute__((vector_size(64)));
typedef long long WideLongs __attribute__((vector_size(64)));
typedef int WideInts __attribute__((vector_size(64)));
typedef short WideShorts __attribute__((vector_size(64)));

constexpr WideLongs neighbour_lanes = {1, 0, 3, 2, 5, 4, 7, 6};

/** \brief Distances to the eight descriptors one after the other at \a others. */
PCL_SEMANTIC_INLINE Shorts
eightDistances(const Bytes* own, const std::uint8_t* others)
{
  static_assert(descriptor_parts == 1, "four descriptors fill the lanes");
  const WideBytes four =
      (WideBytes)__builtin_ia32_broadcasti32x4_512((Ints)*own, WideInts{}, -1);
  WideBytes lower, upper;
  __builtin_memcpy(&lower, others, sizeof lower);
  __builtin_memcpy(&upper, others + sizeof lower, sizeof upper);
  // Half a distance in each 64 bits: those of the upper four beside the lower four's.
  const WideLongs halves = (WideLongs)__builtin_ia32_psadbw512(four, lower) |
                           (WideLongs)__builtin_ia32_psadbw512(four, upper) << 32;
  const WideShorts sums =
      (WideShorts)(halves + __builtin_shuffle(halves, neighbour_lanes));
  return __builtin_shufflevector(sums, sums, 0, 8, 16, 24, 2, 10, 18, 26);
}

#else

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

#endif
