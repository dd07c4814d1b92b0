// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/truncated_sums.h"
#include "point_rows.h"

#include <pcl_semantic/crf/truncated_kernel.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace pcl_semantic {

/** \brief The neighbours of some sorted points, by groups of these. */
struct TruncatedKernel::Chunk {
  static constexpr std::size_t most_points = 256;

  PointRows::Groups groups;
  std::vector<std::uint32_t> lengths;       // points in the runs of each group
  std::vector<std::uint32_t> pair_ends;     // of each group, in pairs
  std::unique_ptr<std::uint32_t[]> weights; // two pairs each
  std::size_t pairs = 0;                    // of all groups
  std::size_t longest = 0;                  // points in the runs of a group
  std::size_t first = 0;                    // point

  void find(const PointRows& rows, std::size_t begin);

  std::size_t
  size() const
  {
    return lengths.size();
  }

  kernels::GroupView
  view(std::size_t g) const
  {
    const std::size_t run = g == 0 ? 0 : groups.run_ends[g - 1];
    const std::size_t point = g == 0 ? first : groups.point_ends[g - 1];
    return {groups.runs.data() + run, groups.run_ends[g] - run, lengths[g], point,
            int(groups.point_ends[g] - point)};
  }

  std::uint32_t*
  weightsOf(std::size_t g) const
  {
    return weights.get() + (g == 0 ? 0 : pair_ends[g - 1]) / 2;
  }
};

} // namespace pcl_semantic
