/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, after distances_tier.hpp.

PCL_SEMANTIC_INLINE std::uint8_t
gradientByte(int sum)
{
  const int value = (sum >> 2) + 128;
  return std::uint8_t(value < 0 ? 0 : value > 255 ? 255 : value);
}

PCL_SEMANTIC_TARGET void
gradients(const std::uint8_t* above, const std::uint8_t* row, const std::uint8_t* below,
          int width, std::uint8_t* __restrict horizontal,
          std::uint8_t* __restrict vertical)
{
  horizontal[0] = vertical[0] = horizontal[width - 1] = vertical[width - 1] = 128;
  for (int u = 1; u < width - 1; ++u) {
    const int right = above[u + 1] + 2 * row[u + 1] + below[u + 1];
    const int left = above[u - 1] + 2 * row[u - 1] + below[u - 1];
    horizontal[u] = gradientByte(right - left);
    const int lower = below[u - 1] + 2 * below[u] + below[u + 1];
    const int upper = above[u - 1] + 2 * above[u] + above[u + 1];
    vertical[u] = gradientByte(lower - upper);
  }
}

PCL_SEMANTIC_TARGET void
gather(const std::uint8_t* const* elements, int count, std::uint8_t* result)
{
  constexpr Bytes low = {0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23};
  constexpr Bytes high = {8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31};
  for (int u = 0; u < count; u += 16)
    for (int part = 0; part < descriptor_parts; ++part) {
      // 16 x 16 bytes change rows with columns by four perfect shuffles.
      Bytes a[16], b[16];
      for (int i = 0; i < 16; ++i)
        a[i] = loadBytes(elements[16 * part + i] + u);
      for (int i = 0; i < 8; ++i) {
        b[2 * i] = __builtin_shuffle(a[i], a[i + 8], low);
        b[2 * i + 1] = __builtin_shuffle(a[i], a[i + 8], high);
      }
      for (int i = 0; i < 8; ++i) {
        a[2 * i] = __builtin_shuffle(b[i], b[i + 8], low);
        a[2 * i + 1] = __builtin_shuffle(b[i], b[i + 8], high);
      }
      for (int i = 0; i < 8; ++i) {
        b[2 * i] = __builtin_shuffle(a[i], a[i + 8], low);
        b[2 * i + 1] = __builtin_shuffle(a[i], a[i + 8], high);
      }
      for (int i = 0; i < 8; ++i) {
        a[2 * i] = __builtin_shuffle(b[i], b[i + 8], low);
        a[2 * i + 1] = __builtin_shuffle(b[i], b[i + 8], high);
      }
      for (int i = 0; i < 16; ++i)
        __builtin_memcpy(result + (u + i) * descriptor_bytes + 16 * part, &a[i], 16);
    }
}

PCL_SEMANTIC_TARGET void
addDistances(const std::uint8_t* own, const std::uint8_t* others, int count,
             std::uint16_t* costs)
{
  Bytes mine[descriptor_parts];
  __builtin_memcpy(mine, own, sizeof mine);
  for (int i = 0; i < count; i += 8) {
    Shorts sums;
    __builtin_memcpy(&sums, costs + i, sizeof sums);
    sums += eightDistances(mine, others + i * descriptor_bytes);
    __builtin_memcpy(costs + i, &sums, sizeof sums);
  }
}
