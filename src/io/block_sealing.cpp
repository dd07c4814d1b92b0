// SPDX-License-Identifier: BSD-3-Clause
#include "block_sealing.h"
#include "block_encoding.h"
#include "sealed_bytes.h"

#include <pcl_semantic/core/parallel_guard.h>

#include <optional>

namespace pcl_semantic {

std::vector<Bytes>
sealBlocks(const IndexedBlocks& blocks, int classes)
{
  std::vector<Bytes> sealed(blocks.size());
  ParallelGuard guard;
#pragma omp parallel
  {
    std::optional<Sealer> sealer; // one a thread
#pragma omp for schedule(dynamic, 16)
    for (std::size_t i = 0; i < blocks.size(); ++i)
      guard.run([&] {
        if (!sealer)
          sealer.emplace();
        sealed[i] =
            sealer->seal(encodeBlock(blocks[i].first, *blocks[i].second, classes));
      });
  }
  guard.rethrow();
  return sealed;
}

std::vector<std::unique_ptr<VoxelBlock>>
openBlocks(const SealedBlocks& blocks,
           const std::function<std::unique_ptr<VoxelBlock>(const VoxelIndex&,
                                                           const Bytes&)>& open)
{
  std::vector<std::unique_ptr<VoxelBlock>> opened(blocks.size());
  ParallelGuard guard;
#pragma omp parallel for schedule(dynamic, 16)
  for (std::size_t i = 0; i < blocks.size(); ++i)
    guard.run([&] { opened[i] = open(blocks[i].first, blocks[i].second); });
  guard.rethrow();
  return opened;
}

} // namespace pcl_semantic
