// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <functional>
#include <memory>
#include <unordered_map>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Where blocks go that leave the window, and come back from.
 *
 * A map calls it from one thread at a time. What a method throws comes out of the map,
 * which stays as it was before the call; after a put() that threw, the block is kept in
 * the window. */
class BlockStore {
public:
  virtual ~BlockStore() = default;

  /** \brief Keeps a copy of a block; replaces what was kept at this index. */
  virtual void put(const VoxelIndex& block, const VoxelBlock& content) = 0;

  /** \brief A copy of what was put at this index; null if nothing was. */
  virtual std::unique_ptr<VoxelBlock> get(const VoxelIndex& block) const = 0;

  /** \brief Visits every block, in the order z, y, x of the indices. */
  virtual void forEach(
      const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit) const = 0;
};

/** \brief Keeps blocks in memory: the map forgets nothing and grows. */
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
