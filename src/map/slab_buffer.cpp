// SPDX-License-Identifier: BSD-3-Clause
#include "slab_buffer.h"

#include <array>
#include <cstring>

namespace pcl_semantic {

namespace {

std::uint64_t
eightBytes(const std::uint8_t* from)
{
  std::uint64_t bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  return bytes;
}

// Bit i of the result is byte i, which is 0 or 1.
std::uint64_t
eightBits(std::uint64_t bytes)
{
  return bytes * 0x0102040810204080u >> 56;
}

constexpr std::size_t line_size = 64; // eight rows of eight layers

bool
isEmpty(const std::uint8_t* line)
{
  std::uint64_t any = 0;
  for (std::size_t k = 0; k < line_size; k += 8)
    any |= eightBytes(line + k);
  return any == 0;
}

} // namespace

FaceAxes::FaceAxes(int face)
    : along(face / 2), row(along == 1 ? 0 : 1), column(along == 2 ? 0 : 2),
      step(face % 2 ? -1 : 1)
{}

void
SlabBuffer::begin(const VoxelIndex& start, const FaceAxes& axes, const Extent& extent)
{
  axes_ = axes;
  const int first_row = (start[axes.row] + extent.first_row) & ~(kBlockEdge - 1);
  corner_[axes.row] = first_row;
  corner_[axes.column] = start[axes.column] + extent.first_column;
  first_row_ = first_row - start[axes.row];
  first_column_ = extent.first_column;
  const int rows = extent.last_row - first_row_ + 1;
  lines_ = (rows + kBlockEdge - 1) / kBlockEdge;
  columns_ = extent.last_column - extent.first_column + 1;
  const std::size_t size = std::size_t(columns_) * std::size_t(lines_) * line_size;
  if (cells_.size() < size + line_size) // one more line for what lies nowhere
    cells_.resize(size + line_size);
}

void
SlabBuffer::show(int layer, kernels::SlabView& slab)
{
  slab.first_row = first_row_;
  slab.first_column = first_column_;
  slab.rows = lines_ * kBlockEdge;
  slab.columns = columns_;
  slab.column_stride = lines_ * int(line_size);
  slab.nowhere = columns_ * slab.column_stride;
  slab.cells = cells_.data() + layer;
}

void
SlabBuffer::flush(int block_along, CrossedVoxels& crossed)
{
  VoxelIndex block;
  block[axes_.along] = block_along;
  std::uint8_t* line = cells_.data();
  for (int c = 0; c < columns_; ++c) {
    const int column = corner_[axes_.column] + c;
    block[axes_.column] = column >> kBlockBits;
    for (int l = 0; l < lines_; ++l, line += line_size) {
      if (isEmpty(line))
        continue;
      block[axes_.row] = (corner_[axes_.row] >> kBlockBits) + l;
      flushLine(line, crossed.slotOf(block), column & (kBlockEdge - 1), crossed);
      std::memset(line, 0, line_size);
    }
  }
  std::memset(line, 0, line_size);
}

void
SlabBuffer::flushLine(const std::uint8_t* line, std::size_t slot, int column,
                      CrossedVoxels& crossed) const
{
  std::uint64_t bits = 0;
  std::array<std::uint64_t, kBlockEdge> by_layer{};
  for (int row = 0; row < kBlockEdge; ++row) {
    const std::uint64_t layers = eightBytes(line + row * kBlockEdge);
    if (axes_.along == 0) // layers are x, rows y, the column is z
      bits |= eightBits(layers) << (row * kBlockEdge);
    else if (axes_.along == 1) // layers are y, rows x, the column is z
      bits |= layers << row;
    else // layers are z, rows y, the column is x
      for (int z = 0; z < kBlockEdge; ++z)
        by_layer[z] |= (layers >> (8 * z) & 1) << (row * kBlockEdge + column);
  }
  if (axes_.along != 2)
    crossed.add(slot, column, bits);
  else
    for (int z = 0; z < kBlockEdge; ++z)
      crossed.add(slot, z, by_layer[z]);
}

} // namespace pcl_semantic
