/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, with PCL_SEMANTIC_TARGET its instruction set.

typedef std::int16_t Shorts __attribute__((vector_size(2 * block)));
typedef float Floats __attribute__((vector_size(4 * block)));

#define PCL_SEMANTIC_INLINE PCL_SEMANTIC_TARGET inline __attribute__((always_inline))

PCL_SEMANTIC_INLINE void
smoothBlock(const std::int16_t* disparity, const std::int16_t* const* neighbours,
            int places, std::int16_t limit, std::size_t at, std::size_t length,
            std::int16_t* smooth)
{
  Shorts centre = {}, sum = {}, number = {}, other = {};
  __builtin_memcpy(&centre, disparity + at, length * sizeof *disparity);
  for (int place = 0; place < places; ++place) {
    __builtin_memcpy(&other, neighbours[place] + at, length * sizeof *disparity);
    const Shorts difference = other - centre;
    const Shorts counts =
        (other >= 0) & (difference <= limit) & (difference >= std::int16_t(-limit));
    sum += difference & counts;
    number -= counts; // a comparison gives 0 or -1
  }
  number -= number == 0; // where the pixel itself holds nothing
  const Floats mean =
      __builtin_convertvector(sum, Floats) / __builtin_convertvector(number, Floats);
  // Of a positive number: to the nearest whole one.
  const Shorts value = __builtin_convertvector(
      __builtin_convertvector(centre, Floats) + mean + 0.5f, Shorts);
  const Shorts result = centre < 0 ? centre : value;
  __builtin_memcpy(smooth + at, &result, length * sizeof *smooth);
}

PCL_SEMANTIC_TARGET void
smoothLine(const std::int16_t* disparity, const std::int16_t* const* neighbours,
           int places, int range, int count, std::int16_t* smooth)
{
  const std::size_t end = std::size_t(count), whole = end / block * block;
  for (std::size_t at = 0; at < whole; at += block)
    smoothBlock(disparity, neighbours, places, std::int16_t(range), at, block, smooth);
  if (whole < end)
    smoothBlock(disparity, neighbours, places, std::int16_t(range), whole, end - whole,
                smooth);
}
