// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "files/bytes.h"

#include <pcl_semantic/map/semantic_voxel.h>

#include <memory>

namespace pcl_semantic {

/** \brief Encodes a block without loss: index, occupancy of all voxels, mask of those
 * with records, and the records column by column in the order of offset; doc/map.md
 * describes the layout. The bytes do not depend on the order in which voxels were hit.
 * \param[in] classes L
 * \throws InvalidParameterException if the sizes of the block's vectors are
 * inconsistent */
Bytes encodeBlock(const VoxelIndex& index, const VoxelBlock& block, int classes);

/** \brief Decodes the output of encodeBlock().
 * \throws BadInputException if the bytes are of another block or number of classes, or
 * invalid */
std::unique_ptr<VoxelBlock> decodeBlock(const Bytes& bytes, const VoxelIndex& index,
                                        int classes);

/** \brief Compresses bytes into one zstd frame with their size and checksum.
 * Deterministic. Not thread-safe. */
class Sealer {
public:
  Sealer();
  ~Sealer();

  /** \throws std::bad_alloc */
  Bytes seal(const Bytes& content);

private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/** \brief Decompresses sealed bytes.
 * \param[in] data, size the frame
 * \param[in] most maximum size of the content, which limits the memory
 * \throws BadInputException if the frame is damaged, has no size or checksum, or is
 * followed by other bytes */
Bytes unseal(const void* data, std::size_t size, std::size_t most);

} // namespace pcl_semantic
