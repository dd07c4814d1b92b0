// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/map/block_store.h>

#include <algorithm>
#include <vector>

namespace pcl_semantic {

void
MemoryBlockStore::put(const VoxelIndex& block, const VoxelBlock& content)
{
  blocks_.insert_or_assign(block, content);
}

std::unique_ptr<VoxelBlock>
MemoryBlockStore::get(const VoxelIndex& block) const
{
  const auto found = blocks_.find(block);
  return found == blocks_.end() ? nullptr : std::make_unique<VoxelBlock>(found->second);
}

void
MemoryBlockStore::forEach(
    const std::function<void(const VoxelIndex&, const VoxelBlock&)>& visit) const
{
  std::vector<VoxelIndex> order;
  for (const auto& entry : blocks_)
    order.push_back(entry.first);
  std::sort(order.begin(), order.end(), VoxelIndexLess());
  for (const VoxelIndex& block : order)
    visit(block, blocks_.at(block));
}

} // namespace pcl_semantic
