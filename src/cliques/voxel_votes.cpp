// SPDX-License-Identifier: BSD-3-Clause
#include "voxel_votes.h"

#include <pcl_semantic/core/parallel_guard.h>
#include <pcl_semantic/core/quantized_point.h>
#include <pcl_semantic/core/voxel_table.h>

#include <algorithm>
#include <cstdint>

namespace pcl_semantic {

namespace {

// Neighbouring pixels of a row that fall in one voxel and belong to one part.
struct Vote {
  std::int32_t voxel;
  int part;
  int pixels;
};

class Voting {
public:
  Voting(const CliqueGenerator::Cloud& cloud, const SurfaceParts& parts,
         const Eigen::Isometry3d& T_world_camera, const VoxelTable& table,
         double voxel_size)
      : cloud_(cloud), parts_(parts), T_world_camera_(T_world_camera), table_(table),
        voxel_size_(voxel_size)
  {}

  std::vector<Vote>
  votesOfRow(int v) const
  {
    std::vector<Vote> votes;
    const int* const parts = parts_.numbers.ptr<int>(v);
    const Eigen::Isometry3d T_world_camera = T_world_camera_;
    const double voxel_size = voxel_size_, farthest = kMaxVoxelIndex * voxel_size_;
    VoxelIndex last = VoxelIndex::Constant(kMaxVoxelIndex);
    std::int32_t voxel = VoxelTable::kNone; // that `last` is
    for (int u = 0; u < parts_.numbers.cols; ++u) {
      if (parts[u] < 0)
        continue;
      const Eigen::Vector3d point =
          T_world_camera *
          cloud_(std::size_t(u), std::size_t(v)).getVector3fMap().cast<double>();
      if (!(point.array().abs() < farthest).all())
        continue;
      const VoxelIndex index = voxelOf(quantize(point, voxel_size));
      if (index != last)
        voxel = table_.find(index);
      last = index;
      if (voxel == VoxelTable::kNone)
        continue;
      if (votes.empty() || votes.back().voxel != voxel || votes.back().part != parts[u])
        votes.push_back({voxel, parts[u], 0});
      ++votes.back().pixels;
    }
    return votes;
  }

private:
  const CliqueGenerator::Cloud& cloud_;
  const SurfaceParts& parts_;
  const Eigen::Isometry3d& T_world_camera_;
  const VoxelTable& table_;
  double voxel_size_;
};

// Brings votes together by voxel: counts those of each, then puts them in their places.
std::vector<Vote>
sortByVoxel(const std::vector<std::vector<Vote>>& rows, std::vector<std::size_t>& first)
{
  for (const std::vector<Vote>& row : rows)
    for (const Vote& vote : row)
      ++first[std::size_t(vote.voxel) + 1];
  for (std::size_t i = 1; i < first.size(); ++i)
    first[i] += first[i - 1];
  std::vector<Vote> sorted(first.back());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (const std::vector<Vote>& row : rows)
    for (const Vote& vote : row)
      sorted[next[std::size_t(vote.voxel)]++] = vote;
  return sorted;
}

int
winnerOf(Vote* begin, Vote* end)
{
  std::sort(begin, end, [](const Vote& a, const Vote& b) { return a.part < b.part; });
  int winner = -1, most = 0;
  for (const Vote* vote = begin; vote != end;) {
    const int part = vote->part;
    int pixels = 0;
    for (; vote != end && vote->part == part; ++vote)
      pixels += vote->pixels;
    if (pixels > most) {
      most = pixels;
      winner = part;
    }
  }
  return winner;
}

} // namespace

std::vector<int>
partsOfVoxels(const CliqueGenerator::Cloud& cloud, const SurfaceParts& parts,
              const Eigen::Isometry3d& T_world_camera,
              const std::vector<VoxelIndex>& voxels, double voxel_size)
{
  const VoxelTable table(voxels);
  const Voting voting(cloud, parts, T_world_camera, table, voxel_size);
  std::vector<std::vector<Vote>> rows(std::size_t(parts.numbers.rows));
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 8)
  for (std::size_t v = 0; v < rows.size(); ++v)
    guard.run([&] { rows[v] = voting.votesOfRow(int(v)); });
  guard.rethrow();
  std::vector<std::size_t> first(voxels.size() + 1, 0);
  std::vector<Vote> votes = sortByVoxel(rows, first);
  std::vector<int> winners(voxels.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < winners.size(); ++i)
    winners[i] = winnerOf(votes.data() + first[i], votes.data() + first[i + 1]);
  if (table.hasTwins()) // the votes are for the first of them
    for (std::size_t i = 0; i < winners.size(); ++i)
      winners[i] = winners[std::size_t(table.find(voxels[i]))];
  return winners;
}

} // namespace pcl_semantic
