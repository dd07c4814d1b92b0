// SPDX-License-Identifier: BSD-3-Clause
#include "moved_archive.h"

#include "core/fail.h"
#include "core/parallel_guard.h"

#include <pcl_semantic/core/sensor_pose.h>
#include <pcl_semantic/io/archive_merge.h>

#include <algorithm>
#include <array>
#include <unordered_map>
#include <unordered_set>

namespace pcl_semantic {

namespace {

using BlockBox = Eigen::AlignedBox<int, 3>; // both corners inclusive

using Blocks =
    std::unordered_map<VoxelIndex, std::unique_ptr<VoxelBlock>, VoxelIndexHash>;

// The blocks that a moved block, or the centres of its voxels, may reach.
// \param[in] inset 0 for the block's corners, 0.5 for the centres of its outer voxels
BlockBox
blocksAround(const VoxelIndex& block, const Eigen::Isometry3d& motion, double inset)
{
  Eigen::AlignedBox3d box;
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d position = block.cast<double>() * kBlockEdge;
    for (int axis = 0; axis < 3; ++axis)
      position[axis] += corner >> axis & 1 ? kBlockEdge - inset : inset;
    box.extend(motion * position);
  }
  const auto blockAt = [](const Eigen::Vector3d& position) -> VoxelIndex {
    constexpr double farthest = double(kMaxVoxelIndex) / kBlockEdge;
    const Eigen::Array3d found = (position / kBlockEdge).array().floor();
    return found.max(-farthest).min(+farthest).cast<int>();
  };
  return {blockAt(box.min()), blockAt(box.max())};
}

template <typename Visit>
void
forEachIn(const BlockBox& box, Visit&& visit)
{
  for (int z = box.min().z(); z <= box.max().z(); ++z)
    for (int y = box.min().y(); y <= box.max().y(); ++y)
      for (int x = box.min().x(); x <= box.max().x(); ++x)
        visit(VoxelIndex(x, y, z));
}

// Position of a hit in a voxel, as VoxelRecord::position, clamped to it.
std::array<std::uint16_t, 3>
positionIn(const VoxelIndex& voxel, const Eigen::Vector3d& position)
{
  constexpr double unit = 65536.0;
  const Eigen::Array3d inside = ((position - voxel.cast<double>()) * unit).array();
  const Eigen::Array3i stored = inside.floor().max(0.0).min(unit - 1.0).cast<int>();
  return {std::uint16_t(stored.x()), std::uint16_t(stored.y()),
          std::uint16_t(stored.z())};
}

class Resampler {
public:
  Resampler(const Eigen::Isometry3d& motion, int classes)
      : motion_(motion), inverse_(motion.inverse()), classes_(std::size_t(classes))
  {}

  BlockBox
  sourcesOf(const VoxelIndex& block) const
  {
    return blocksAround(block, inverse_, 0.5);
  }

  // \return null if it is unknown
  std::unique_ptr<VoxelBlock>
  resample(const VoxelIndex& index, const Blocks& sources) const
  {
    auto block = std::make_unique<VoxelBlock>();
    bool is_known = false;
    VoxelIndex last(0, 0, 0);
    const VoxelBlock* source = nullptr;
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const VoxelIndex voxel = voxelAt(index, offset);
      const Eigen::Vector3d centre = voxel.cast<double>().array() + 0.5;
      const VoxelIndex from = (inverse_ * centre).array().floor().matrix().cast<int>();
      if (offset == 0 || blockOf(from) != last) {
        last = blockOf(from);
        const auto found = sources.find(last);
        source = found == sources.end() ? nullptr : found->second.get();
      }
      if (!source)
        continue;
      const int from_offset = voxelInBlock(from);
      block->log_odds[std::size_t(offset)] = source->log_odds[std::size_t(from_offset)];
      is_known = is_known || block->log_odds[std::size_t(offset)] != kUnknown;
      if (source->recordAt(from_offset) != VoxelBlock::kNoRecord)
        copyRecord(*source, from, voxel, *block);
    }
    return is_known ? std::move(block) : nullptr;
  }

private:
  void
  copyRecord(const VoxelBlock& source, const VoxelIndex& from, const VoxelIndex& to,
             VoxelBlock& block) const
  {
    const auto old = std::size_t(source.recordAt(voxelInBlock(from)));
    const auto record = std::size_t(block.makeRecord(voxelInBlock(to), int(classes_)));
    block.records[record] = source.records[old];
    const auto& [x, y, z] = source.records[old].position;
    const Eigen::Vector3d position =
        from.cast<double>() + Eigen::Vector3d(x, y, z) / 65536.0;
    block.records[record].position = positionIn(to, motion_ * position);
    for (const auto values : {&VoxelBlock::measured, &VoxelBlock::refined})
      std::copy_n((source.*values).begin() + std::ptrdiff_t(old * classes_), classes_,
                  (block.*values).begin() + std::ptrdiff_t(record * classes_));
  }

  Eigen::Isometry3d motion_, inverse_; // [voxels]
  std::size_t classes_;
};

} // namespace

MovedArchive::MovedArchive(const std::string& path, const Eigen::Isometry3d& motion)
    : archive_(MapReader::open(path)),
      is_moved_(!motion.isApprox(Eigen::Isometry3d::Identity(), 1e-12)), motion_(motion)
{
  requireRigid(motion, path + ": its motion");
  motion_.translation() /= archive_->header().parameters.voxel_size;
  // The indices of voxels at the far end of the diagonal still fit 32 bits.
  constexpr double farthest = 0.25 * kMaxVoxelIndex;
  if (!(motion_.translation().cwiseAbs().maxCoeff() <= farthest)) // or NaN
    badInput(path, ": is moved by ", motion.translation().transpose(),
             " m, expected at most ", farthest, " voxels");
}

std::vector<VoxelIndex>
MovedArchive::indices(const std::function<bool(const VoxelIndex&)>& is_wanted) const
{
  std::vector<VoxelIndex> indices;
  const auto add = [&](const VoxelIndex& index) {
    if (!is_wanted || is_wanted(index))
      indices.push_back(index);
  };
  archive_->forEachIndex([&](const VoxelIndex& index) {
    if (is_moved_)
      forEachIn(blocksAround(index, motion_, 0.0), add);
    else
      add(index);
  });
  std::sort(indices.begin(), indices.end(), VoxelIndexLess());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
  return indices;
}

std::vector<std::unique_ptr<VoxelBlock>>
MovedArchive::read(const std::vector<VoxelIndex>& blocks) const
{
  if (!is_moved_)
    return archive_->get(blocks);
  const Resampler resampler(motion_, archive_->header().label_set.size());
  std::unordered_set<VoxelIndex, VoxelIndexHash> needed;
  for (const VoxelIndex& block : blocks)
    forEachIn(resampler.sourcesOf(block), [&](const VoxelIndex& source) {
      if (archive_->contains(source))
        needed.insert(source);
    });
  std::vector<VoxelIndex> order(needed.begin(), needed.end());
  std::sort(order.begin(), order.end(), VoxelIndexLess()); // file order
  auto read = archive_->get(order);
  Blocks sources;
  for (std::size_t i = 0; i < order.size(); ++i)
    sources.emplace(order[i], std::move(read[i]));
  std::vector<std::unique_ptr<VoxelBlock>> moved(blocks.size());
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 16)
  for (std::size_t i = 0; i < blocks.size(); ++i)
    guard.run([&] { moved[i] = resampler.resample(blocks[i], sources); });
  guard.rethrow();
  return moved;
}

void
requireSameKind(const MapReader& first, const MapReader& other)
{
  const std::string difference = differenceOf(first.header(), other.header());
  if (!difference.empty())
    badInput(other.path(), ": has another ", difference, " than ", first.path());
}

} // namespace pcl_semantic
