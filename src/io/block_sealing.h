// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/byte_writer.h>
#include <pcl_semantic/map/semantic_voxel.h>

#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace pcl_semantic {

using IndexedBlocks = std::vector<std::pair<VoxelIndex, const VoxelBlock*>>;

/** \brief Encodes and compresses blocks on all threads; the result does not depend on
 * how many there are.
 * \param[in] classes L
 * \return a frame a block, see encodeBlock() and Sealer */
std::vector<Bytes> sealBlocks(const IndexedBlocks& blocks, int classes);

using SealedBlocks = std::vector<std::pair<VoxelIndex, Bytes>>;

/** \brief Calls \a open for each block, on all threads. */
std::vector<std::unique_ptr<VoxelBlock>> openBlocks(
    const SealedBlocks& blocks,
    const std::function<std::unique_ptr<VoxelBlock>(const VoxelIndex&, const Bytes&)>&
        open);

} // namespace pcl_semantic
