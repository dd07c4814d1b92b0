// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "kernels/slab_crossing.h"

#include <pcl_semantic/map/crossed_voxels.h>

#include <vector>

namespace pcl_semantic {

/** \brief The axes of a face of directions: rays are longest along one axis; their
 * cells have a row and a column along the two others. */
struct FaceAxes {
  int along, row, column; ///< 0, 1 or 2
  int step;               ///< 1 or -1: direction along the axis

  /** \param[in] face 0..5: twice the axis, and one for its negative direction */
  explicit FaceAxes(int face);
};

/** \brief A byte for each cell of up to eight slabs: those in one layer of blocks. Rays
 * set bytes, which costs little; then they become bits of CrossedVoxels. */
class SlabBuffer {
public:
  /** \brief Range of cells, from the voxel of the start; inside the window. */
  struct Extent {
    int first_row, last_row, first_column, last_column;
  };

  /** \param[in] start voxel of the start */
  void begin(const VoxelIndex& start, const FaceAxes& axes, const Extent& extent);

  /** \brief Completes a view with the bytes of a slab.
   * \param[in] layer of the slab in its block, 0..7 */
  void show(int layer, kernels::SlabView& slab);

  /** \brief Adds the set cells to the crossed voxels, and clears them.
   * \param[in] block_along of the slabs, along the axis */
  void flush(int block_along, CrossedVoxels& crossed);

private:
  void flushLine(const std::uint8_t* line, std::size_t slot, int column,
                 CrossedVoxels& crossed) const;

  std::vector<std::uint8_t> cells_; // by column, row and layer
  FaceAxes axes_{0};
  VoxelIndex corner_ = VoxelIndex::Zero(); // voxel of the first row and column
  int first_row_ = 0, first_column_ = 0;   // from the voxel of the start
  int lines_ = 0, columns_ = 0;            // of eight rows
};

} // namespace pcl_semantic
