// SPDX-License-Identifier: BSD-3-Clause
#include "truncated_chunk.h"

#include "kernels/run_search.h"

#include <algorithm>

namespace pcl_semantic {

void
TruncatedKernel::Chunk::find(const PointRows& rows, std::size_t begin)
{
  first = begin;
  groups = rows.findRuns(begin, std::min(rows.size(), begin + most_points));
  groups.runs.shrink_to_fit();
  std::size_t run = 0;
  for (std::size_t g = 0; g < groups.run_ends.size(); ++g) {
    std::size_t length = 0;
    for (; run < groups.run_ends[g]; ++run)
      length += groups.runs[run] & kernels::run_length_mask;
    lengths.push_back(std::uint32_t(length));
    longest = std::max(longest, length);
    pairs += std::size_t(view(g).points) * kernels::strideOf(length);
    pair_ends.push_back(std::uint32_t(pairs)); // a chunk with more is refused
  }
}

} // namespace pcl_semantic
