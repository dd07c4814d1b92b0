// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "aligned_array.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Numbers 0 ... count - 1 sorted by their bucket, those of one bucket in their
 * order. */
struct SortedBuckets {
  static constexpr std::size_t part_size = 8192; ///< of what threads count at a time

  static constexpr std::size_t
  partsOf(std::size_t count)
  {
    return (count + part_size - 1) / part_size;
  }

  AlignedArray<std::int32_t> members;
  std::vector<std::size_t> begins; ///< of each bucket, with an end

  SortedBuckets(const AlignedArray<std::int32_t>& bucket_of, std::size_t buckets)
      : members(bucket_of.size()), begins(buckets + 1, 0)
  {
    const std::size_t count = bucket_of.size(), parts = partsOf(count);
    // Members of each bucket in each part, then where the first of them goes.
    std::vector<std::size_t> indices(parts * buckets, 0);
#pragma omp parallel for schedule(static)
    for (std::size_t p = 0; p < parts; ++p)
      for (std::size_t i = p * part_size; i < std::min(count, (p + 1) * part_size); ++i)
        ++indices[p * buckets + std::size_t(bucket_of[i])];
    std::size_t sum = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
      begins[b] = sum;
      for (std::size_t p = 0; p < parts; ++p) {
        const std::size_t members_here = indices[p * buckets + b];
        indices[p * buckets + b] = sum;
        sum += members_here;
      }
    }
    begins[buckets] = sum;
#pragma omp parallel for schedule(static)
    for (std::size_t p = 0; p < parts; ++p)
      for (std::size_t i = p * part_size; i < std::min(count, (p + 1) * part_size); ++i)
        members[indices[p * buckets + std::size_t(bucket_of[i])]++] = std::int32_t(i);
  }
};

} // namespace pcl_semantic
