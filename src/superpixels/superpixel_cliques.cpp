// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/superpixels/superpixel_cliques.h>

#include "core/fail.h"
#include "core/parallel_guard.h"
#include "core/voxel_table.h"
#include "slic_cliques.h"

#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/core/voxel_index.h>
#include <pcl_semantic/superpixels/depth_jumps.h>

#include <Eigen/Geometry>
#include <pcl/common/point_tests.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

namespace {

constexpr int kNone = -1;

// Adjacent pixels of a row in the same voxel and part.
struct Vote {
  std::int32_t voxel;
  int part;
  int pixels;
};

// Votes of a row of pixels; their voxels are those of SemanticVoxelMap::integrate().
std::vector<Vote>
votesOfRow(const int* parts, const pcl::PointXYZRGB* points, int width,
           const Eigen::Isometry3d& T_world_camera, const VoxelTable& table,
           double voxel_size)
{
  std::vector<Vote> votes;
  const double farthest = kMaxVoxelIndex * voxel_size;
  VoxelIndex last = VoxelIndex::Constant(kMaxVoxelIndex);
  std::int32_t voxel = VoxelTable::kNone; // voxel of `last`
  for (int u = 0; u < width; ++u) {
    if (parts[u] < 0)
      continue;
    const Eigen::Vector3d point =
        T_world_camera * points[u].getVector3fMap().cast<double>();
    if (!(point.array().abs() < farthest).all())
      continue;
    const VoxelIndex index = voxelOf(quantize(point, voxel_size));
    if (index != last)
      voxel = table.find(index);
    last = index;
    if (voxel == VoxelTable::kNone)
      continue;
    if (votes.empty() || votes.back().voxel != voxel || votes.back().part != parts[u])
      votes.push_back({voxel, parts[u], 0});
    ++votes.back().pixels;
  }
  return votes;
}

// Counting sort of the votes by voxel.
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
  int winner = kNone, most = 0;
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

// The part with the most pixels in each voxel, the lowest in a tie; kNone = no pixel.
// The list may contain a voxel several times.
std::vector<int>
partsOfVoxels(const CliqueGenerator::Cloud& cloud, const SurfaceParts& parts,
              const Eigen::Isometry3d& T_world_camera,
              const std::vector<VoxelIndex>& voxels, double voxel_size)
{
  const VoxelTable table(voxels);
  std::vector<std::vector<Vote>> rows(cloud.height);
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 8)
  for (std::size_t v = 0; v < rows.size(); ++v)
    guard.run([&] {
      rows[v] = votesOfRow(parts.numbers.ptr<int>(int(v)), &cloud(0, v),
                           int(cloud.width), T_world_camera, table, voxel_size);
    });
  guard.rethrow();
  std::vector<std::size_t> first(voxels.size() + 1, 0);
  std::vector<Vote> votes = sortByVoxel(rows, first);
  std::vector<int> winners(voxels.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < winners.size(); ++i)
    winners[i] = winnerOf(votes.data() + first[i], votes.data() + first[i + 1]);
  if (table.hasTwins()) // votes were counted for the first duplicate
    for (std::size_t i = 0; i < winners.size(); ++i)
      winners[i] = winners[std::size_t(table.find(voxels[i]))];
  return winners;
}

// Renumbers parts without gaps, in the order of their first points.
int
renumber(std::vector<int>& parts)
{
  int largest = kNone, count = 0;
  for (const int part : parts)
    largest = std::max(largest, part);
  std::vector<int> numbers(std::size_t(largest + 1), kNone);
  for (int& part : parts) {
    if (part == kNone)
      continue;
    int& number = numbers[std::size_t(part)];
    if (number == kNone)
      number = count++;
    part = number;
  }
  return count;
}

} // namespace

void
SuperpixelParameters::validate() const
{
  slic.validate();
  DepthJumps{passing_distance, 0.0}.validate();
  if (min_voxels < 1)
    badParameter("superpixels: min_voxels is ", min_voxels, ", expected 1 or more");
}

SuperpixelCliques::SuperpixelCliques(const SuperpixelParameters& parameters)
    : parameters_(parameters)
{
  parameters_.validate();
}

void
SuperpixelCliques::setFrame(const Cloud::ConstPtr& cloud,
                            const Eigen::Isometry3d& T_world_camera)
{
  requireRigid(T_world_camera, "superpixels: the pose of the frame");
  if (cloud)
    requireOrganized(*cloud);
  frame_ = cloud;
  T_world_camera_ = T_world_camera;
}

void
SuperpixelCliques::setVoxels(const std::vector<VoxelIndex>& indices, double voxel_size)
{
  if (!(voxel_size > 0.0 && std::isfinite(voxel_size)))
    badParameter("superpixels: voxel size is ", voxel_size, " m, expected more than 0");
  voxels_ = indices;
  voxel_size_ = voxel_size;
}

std::vector<pcl::PointIndices>
SuperpixelCliques::generate(const Cloud& cloud)
{
  if (cloud.size() != voxels_.size())
    badParameter("superpixels: ", voxels_.size(), " voxels for a cloud of ",
                 cloud.size(), " points");
  std::vector<int> parts(voxels_.size(), kNone);
  if (frame_ && !frame_->empty() && !voxels_.empty())
    parts = partsOfVoxels(
        *frame_,
        splitAtDepthJumps(slicSuperpixels(*frame_, parameters_.slic), *frame_,
                          {parameters_.passing_distance, 2.0 * voxel_size_}),
        T_world_camera_, voxels_, voxel_size_);
  if (parameters_.keep)
    keepParts(parts);
  std::vector<pcl::PointIndices> cliques(std::size_t(renumber(parts)));
  if (parameters_.keep) {
    kept_voxels_ = voxels_;
    kept_parts_ = parts;
  }
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (parts[i] != kNone && pcl::isXYZFinite(cloud[i]))
      cliques[std::size_t(parts[i])].indices.push_back(pcl::index_t(i));
  const auto is_small = [&](const pcl::PointIndices& clique) {
    return clique.indices.size() < std::size_t(parameters_.min_voxels);
  };
  cliques.erase(std::remove_if(cliques.begin(), cliques.end(), is_small),
                cliques.end());
  return cliques;
}

// Points outside the frame's view keep their previous part.
void
SuperpixelCliques::keepParts(std::vector<int>& parts)
{
  const int first =
      parts.empty() ? 0 : 1 + *std::max_element(parts.begin(), parts.end());
  const VoxelTable table(kept_voxels_);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] != kNone)
      continue;
    const std::int32_t kept = table.find(voxels_[i]);
    if (kept != VoxelTable::kNone && kept_parts_[std::size_t(kept)] != kNone)
      parts[i] = first + kept_parts_[std::size_t(kept)];
  }
}

} // namespace pcl_semantic
