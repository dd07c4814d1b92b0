/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

// Included once a tier, with PCL_SEMANTIC_TARGET its instruction set: the loops are
// those that compilers make as wide as it allows.

PCL_SEMANTIC_TARGET void
addLogs(const float* values, std::size_t count, float smallest, std::int64_t* sums)
{
  for (std::size_t begin = 0; begin < count; begin += log_block) {
    float block[log_block];
    std::int32_t logs[log_block];
    const std::size_t length = count - begin < log_block ? count - begin : log_block;
    loadBlock(values + begin, length, block);
    for (std::size_t k = 0; k < log_block; ++k) {
      // A power of two and a polynomial for 2/3 to 4/3 (Chebyshev).
      const float value = block[k] > smallest ? block[k] : smallest;
      std::int32_t bits;
      __builtin_memcpy(&bits, &value, sizeof bits);
      const std::int32_t exponent = (bits - 0x3F2AAAAB) >> 23;
      bits -= exponent * (1 << 23);
      float x;
      __builtin_memcpy(&x, &bits, sizeof x);
      x -= 1.0f;
      float p = 0.13748309f * x - 0.15394272f;
      p = p * x + 0.14055812f;
      p = p * x - 0.16414520f;
      p = p * x + 0.20007233f;
      p = p * x - 0.25007930f;
      p = p * x + 0.33333272f;
      p = p * x - 0.49999934f;
      p = (p * x + 1.0f) * x;
      constexpr float scale = float(1 << log_fraction_bits);
      constexpr std::int32_t log_two = 11629080;
      logs[k] = exponent * log_two + static_cast<std::int32_t>(p * scale);
    }
    // Compilers would take the lanes apart one by one.
    typedef std::int32_t Narrow __attribute__((vector_size(32)));
    typedef std::int64_t Wide __attribute__((vector_size(64)));
    for (std::size_t k = 0; k < log_block; k += 8) {
      Narrow narrow;
      Wide sum;
      __builtin_memcpy(&narrow, logs + k, sizeof narrow);
      __builtin_memcpy(&sum, sums + begin + k, sizeof sum);
      sum += __builtin_convertvector(narrow, Wide);
      __builtin_memcpy(sums + begin + k, &sum, sizeof sum);
    }
  }
}
