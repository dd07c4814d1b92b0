// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/files/byte_reader.h>

#include <pcl_semantic/map/semantic_voxel.h>

#include <memory>

namespace pcl_semantic {

/** \brief Bytes of an encoded block with \a records of \a classes. */
std::size_t encodedBlockSize(std::size_t records, int classes);

/** \brief A block as bytes, without loss: index, occupancy of all voxels, mask of those
 * with records, and the records column by column in the order of place; doc/map.md has
 * the layout. The same voxels give the same bytes, in whatever order they were hit.
 * \param[in] classes L
 * \throws InvalidParameterException if the block's vectors do not fit each other */
Bytes encodeBlock(const VoxelIndex& index, const VoxelBlock& block, int classes);

/** \brief Reads what encodeBlock() wrote.
 * \throws BadInputException if it is another block's, or of another number of classes,
 * or not what encodeBlock() writes */
std::unique_ptr<VoxelBlock> decodeBlock(const Bytes& bytes, const VoxelIndex& index,
                                        int classes);

} // namespace pcl_semantic
