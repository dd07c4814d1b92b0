// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "files/bytes.h"

#include <pcl_semantic/map/semantic_voxel.h>

#include <memory>

namespace pcl_semantic {

/** \brief A block as bytes, without loss: index, occupancy of all voxels, mask of those
 * with records, and the records column by column in the order of offset; doc/map.md has
 * the layout. The same voxels give the same bytes, in whatever order they were hit.
 * \param[in] classes L
 * \throws InvalidParameterException if the block's vectors do not fit each other */
Bytes encodeBlock(const VoxelIndex& index, const VoxelBlock& block, int classes);

/** \brief Reads what encodeBlock() wrote.
 * \throws BadInputException if it is another block's, or of another number of classes,
 * or not what encodeBlock() writes */
std::unique_ptr<VoxelBlock> decodeBlock(const Bytes& bytes, const VoxelIndex& index,
                                        int classes);

/** \brief Compresses bytes into one zstd frame that holds their size and a checksum of
 * them. The same bytes give the same frame. For one thread at a time. */
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

/** \brief The bytes that were sealed.
 * \param[in] data, size the frame
 * \param[in] most bytes that the content may have; no more memory is taken
 * \throws BadInputException if the frame is damaged, lacks its size or checksum, or
 * something lies behind it */
Bytes unseal(const void* data, std::size_t size, std::size_t most);

} // namespace pcl_semantic
