/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/map/block_store.h>

namespace pcl_semantic {

void
MemoryBlockStore::put(const VoxelIndex& block, std::unique_ptr<VoxelBlock> content)
{
  blocks_[block] = std::move(content);
}

std::unique_ptr<VoxelBlock>
MemoryBlockStore::take(const VoxelIndex& block)
{
  const auto found = blocks_.find(block);
  if (found == blocks_.end())
    return nullptr;
  std::unique_ptr<VoxelBlock> content = std::move(found->second);
  blocks_.erase(found);
  return content;
}

void
MemoryBlockStore::forEach(
    const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit) const
{
  for (const auto& [index, block] : blocks_)
    visit(index, *block);
}

} // namespace pcl_semantic
