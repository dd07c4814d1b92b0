/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, with PCL_SEMANTIC_TARGET its instruction set and
// PCL_SEMANTIC_LANES its width: vectors have to be of that width where they are
// written, in a template inlined later they would have been taken apart.

#define PCL_SEMANTIC_INLINE inline PCL_SEMANTIC_TARGET __attribute__((always_inline))

constexpr std::size_t lanes = PCL_SEMANTIC_LANES;
typedef float Floats __attribute__((vector_size(4 * lanes)));
typedef std::uint32_t Words __attribute__((vector_size(4 * lanes)));
typedef float Eight __attribute__((vector_size(32)));

// Vectors anywhere in memory.
struct Unaligned {
  typedef Floats F __attribute__((aligned(4), may_alias));
  typedef Eight E __attribute__((aligned(4), may_alias));
  typedef Words W __attribute__((aligned(4), may_alias));
};

PCL_SEMANTIC_INLINE Floats
load(const float* from)
{
  return *reinterpret_cast<const Unaligned::F*>(from);
}

PCL_SEMANTIC_INLINE void
store(const Floats& values, float* to)
{
  *reinterpret_cast<Unaligned::F*>(to) = values;
}

PCL_SEMANTIC_INLINE Words
load(const std::uint32_t* from)
{
  return *reinterpret_cast<const Unaligned::W*>(from);
}

PCL_SEMANTIC_INLINE void
store(const Words& values, std::uint32_t* to)
{
  *reinterpret_cast<Unaligned::W*>(to) = values;
}

PCL_SEMANTIC_INLINE void
copyHalf(const float* from, float* to)
{
  *reinterpret_cast<Unaligned::E*>(to) = *reinterpret_cast<const Unaligned::E*>(from);
}

PCL_SEMANTIC_INLINE Words
lane()
{
  Words numbers{};
  for (std::size_t k = 0; k < lanes; ++k)
    numbers[k] = std::uint32_t(k);
  return numbers;
}

// 2^v for v <= 0, to 8e-5 (Remez): enough for weights of 8 bits.
PCL_SEMANTIC_INLINE Floats
powerOfTwo(const Floats& v)
{
  const float magic = 12582912.0f; // 1.5 * 2^23: a sum with it is rounded to an integer
  const Floats shifted = v + magic;
  const Floats fraction = v - (shifted - magic);
  Floats power = fraction * 0.0551716691f + 0.2426111222f;
  power = power * fraction + 0.6932609855f;
  power = power * fraction + 0.9999280735f;
  const Words bits = (Words)power + ((Words)shifted << 23);
  return (Floats)(v >= -126.0f ? bits : Words{});
}

// Two vectors of bfloat16 in one: first in the lower halves, second in the upper ones.
PCL_SEMANTIC_INLINE Words
pack(const Floats& first, const Floats& second)
{
  constexpr std::uint32_t half = 0x8000; // to the nearest
  return (((Words)first + half) >> 16) | (((Words)second + half) & 0xFFFF0000u);
}

PCL_SEMANTIC_INLINE Floats
firstOf(const Words& packed)
{
  return (Floats)(packed << 16);
}

PCL_SEMANTIC_INLINE Floats
secondOf(const Words& packed)
{
  return (Floats)(packed & 0xFFFF0000u);
}

PCL_SEMANTIC_INLINE float
sumOf(const Floats& values)
{
  float parts[lanes];
  store(values, parts);
  for (std::size_t half = lanes / 2; half > 0; half /= 2)
    for (std::size_t k = 0; k < half; ++k)
      parts[k] += parts[k + half];
  return parts[0];
}

// A line of values of pairs, of whole blocks, as words.
PCL_SEMANTIC_INLINE void
packLine(const float* line, std::size_t length, std::uint32_t* words)
{
  constexpr std::size_t half = pair_block / 2;
  for (std::size_t e = 0; e < length; e += pair_block)
    for (std::size_t k = e; k < e + half; k += lanes, words += lanes)
      store(pack(load(line + k), load(line + k + half)), words);
}

PCL_SEMANTIC_INLINE void
unpackLine(const std::uint32_t* words, std::size_t length, float* line)
{
  constexpr std::size_t half = pair_block / 2;
  for (std::size_t e = 0; e < length; e += pair_block)
    for (std::size_t k = e; k < e + half; k += lanes, words += lanes) {
      __builtin_prefetch(words + 192); // else a sixth of the time goes in waiting
      const Words both = load(words);
      store(firstOf(both), line + k);
      store(secondOf(both), line + k + half);
    }
}
