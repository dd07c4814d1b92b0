// SPDX-License-Identifier: BSD-3-Clause
#include "ray_directions.h"
#include "core/simd_choice.h"
#include "map/directed_ray.h"
#include "map/ray_traversal.h"

#define HWY_TARGET_INCLUDE "map/kernels/ray_directions.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// Vectorised loops over whole batches, whose last rays may be unused.

HWY_BEFORE_NAMESPACE();
namespace pcl_semantic::kernels::HWY_NAMESPACE {

namespace {

void
findEnds(const RayStart& start, RayBatch& rays)
{
  for (int axis = 0; axis < 3; ++axis) {
    const double* const pose = start.pose[axis];
    const double scale = start.scale, from = start.start[axis];
    const std::int32_t in_voxel = start.in_voxel[axis];
    for (std::size_t k = 0; k < RayBatch::capacity; ++k) {
      const double fraction = rays.fraction[k];
      const double x = fraction * double(rays.x[k]), y = fraction * double(rays.y[k]),
                   z = fraction * double(rays.z[k]);
      const double world = ((pose[0] * x + pose[1] * y) + pose[2] * z) + pose[3];
      const double value = world * scale;
      // Adding it rounds to the nearest integer, from which the floor follows.
      constexpr double magic = 0x1.8p52;
      const double nearest = (value + magic) - magic;
      const std::int32_t end =
          static_cast<std::int32_t>(nearest - from) - std::int32_t(nearest > value);
      rays.end[axis][k] = end;
      rays.cell[axis][k] = (end + in_voxel) >> kQuantizationBits;
    }
  }
}

// Branch-free; compilers may turn ?: into a branch.
HWY_INLINE std::int32_t
choose(bool first, std::int32_t a, std::int32_t b)
{
  return b ^ ((a ^ b) & -std::int32_t(first));
}

// Inserts a gap after each of up to 8 bits.
HWY_INLINE std::int32_t
spread(std::int32_t bits)
{
  bits = (bits | bits << 4) & 0x0F0F;
  bits = (bits | bits << 2) & 0x3333;
  return (bits | bits << 1) & 0x5555;
}

void
findDirections(const RayStart& start, RayBatch& rays)
{
  findEnds(start, rays);
  for (std::size_t k = 0; k < RayBatch::capacity; ++k) {
    const std::int32_t x = rays.end[0][k], y = rays.end[1][k], z = rays.end[2][k];
    const std::int32_t length_x = __builtin_abs(x), length_y = __builtin_abs(y),
                       length_z = __builtin_abs(z);
    const bool along_z = (length_z > length_x) & (length_z > length_y);
    const bool along_y = !along_z & (length_y > length_x);
    const std::int32_t along = choose(along_z, z, choose(along_y, y, x));
    const std::int32_t row = choose(along_y, x, y), column = choose(along_z, x, z);
    const std::int32_t length = __builtin_abs(along);
    const auto divisor = double(length > 1 ? length : 1);
    const float row_slope = float(double(row) / divisor);
    const float column_slope = float(double(column) / divisor);
    rays.row_slope[k] = row_slope;
    rays.column_slope[k] = column_slope;

    const std::int32_t cell_x = rays.cell[0][k], cell_y = rays.cell[1][k],
                       cell_z = rays.cell[2][k];
    const std::int32_t slab = choose(along_z, cell_z, choose(along_y, cell_y, cell_x));
    rays.end_slab[k] = __builtin_abs(slab);
    rays.end_row[k] = choose(along_y, cell_x, cell_y);
    rays.end_column[k] = choose(along_z, cell_x, cell_z);

    constexpr std::int32_t leaves = 1 << (kTileBits + kLeafBits); // slopes from -1 to 1
    constexpr std::int32_t leaf_mask = (1 << kLeafBits) - 1;
    const auto row_cell =
        static_cast<std::int32_t>((row_slope + 1.0f) * float(leaves / 2));
    const auto column_cell =
        static_cast<std::int32_t>((column_slope + 1.0f) * float(leaves / 2));
    const std::int32_t row_place = row_cell < leaves ? row_cell : leaves - 1;
    const std::int32_t column_place = column_cell < leaves ? column_cell : leaves - 1;
    const std::int32_t face = 4 * along_z + 2 * along_y + (along < 0);
    rays.tile[k] = face * kTilesAFace + ((column_place >> kLeafBits) << kTileBits) +
                   (row_place >> kLeafBits);
    rays.leaf[k] =
        spread(column_place & leaf_mask) << 1 | spread(row_place & leaf_mask);
  }
}

} // namespace

} // namespace pcl_semantic::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pcl_semantic::kernels {

FindDirections
findDirections(SimdTier tier)
{
  return PCL_SEMANTIC_OF_TIER(tier, findDirections);
}

} // namespace pcl_semantic::kernels
#endif
