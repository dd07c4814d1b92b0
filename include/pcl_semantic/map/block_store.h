// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <functional>
#include <memory>
#include <unordered_map>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Store for the blocks outside the window.
 *
 * A map calls it from one thread at a time. Exceptions pass through the map, which
 * stays as it was before the call. After a put() that threw, the block stays in the
 * window. */
class BlockStore {
public:
  virtual ~BlockStore() = default;

  /** \brief Stores a copy of a block; replaces an earlier one at this index. */
  virtual void put(const VoxelIndex& block, const VoxelBlock& content) = 0;

  /** \brief A copy of the block at this index; null if there is none. */
  virtual std::unique_ptr<VoxelBlock> get(const VoxelIndex& block) const = 0;

  /** \brief Visits every block, in the order z, y, x of the indices. */
  virtual void forEach(
      const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit) const = 0;
};

/** \brief Stores blocks in memory, which grows with the map. */
class MemoryBlockStore : public BlockStore {
public:
  void put(const VoxelIndex& block, const VoxelBlock& content) override;

  std::unique_ptr<VoxelBlock> get(const VoxelIndex& block) const override;

  void forEach(const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit)
      const override;

private:
  std::unordered_map<VoxelIndex, VoxelBlock, VoxelIndexHash> blocks_;
};

} // namespace pcl_semantic
