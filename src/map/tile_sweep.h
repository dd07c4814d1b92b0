// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "ray_tile.h"
#include "slab_buffer.h"

#include <pcl_semantic/core/simd.h>
#include <pcl_semantic/map/crossed_voxels.h>
#include <pcl_semantic/map/ray_traversal.h>

#include <array>
#include <vector>

namespace pcl_semantic {

/** \brief Finds the voxels that the rays of a tile cross: the same set as traversing
 * each of them, but many rays at a time.
 *
 * Goes outward slab by slab (layers of voxels across the axis along which the rays are
 * longest). Near the start a bundle of rays is narrower than a voxel: where its
 * outermost rays show which voxels it crosses, these are set. Bundles of which that is
 * not certain are taken apart, in the end into rays; what single precision cannot
 * decide of a ray goes to the exact traversal. */
class TileSweep {
public:
  /** \param[in] start of all rays
   * \param[in] ends of all rays of the scan from there, by point */
  TileSweep(SimdTier tier, const QuantizedPoint& start,
            const std::vector<RayDelta>& ends, CrossedVoxels& crossed);

  /** \brief Adds the voxels of the window that the rays of a tile cross.
   * \param[in] face 0..5, see FaceAxes */
  void run(int face, const DirectedRay* const* rays, std::size_t count);

private:
  // Slabs of one layer of blocks: first to last, outward.
  struct Group {
    int first, last;
    int block; // along the axis
  };

  bool beginGroup(const Group& group);

  float enterDistance(int slab) const;

  kernels::SlabView viewOf(int number);

  void crossAllRays(const Group& group);

  void crossBundles(const kernels::SlabView& slab, const BundleRows& bundles,
                    int level);

  void crossRays(const kernels::SlabView& slab, const BundleRows& bundles,
                 std::size_t count);

  void crossExactly(std::uint32_t point, int slab);

  const kernels::SlabCrossing& loops_;
  const QuantizedPoint start_;
  const VoxelIndex start_voxel_;
  const std::vector<RayDelta>& ends_;
  CrossedVoxels& crossed_;
  FaceAxes axes_{0};
  float to_first_side_ = 0.0f; // from the start, along the axis [voxels]
  RayTile tile_;
  SlabBuffer buffer_;
  int level_ = 0;     // of the bundles of a group; -1: rays
  int groups_ = 0;    // that were begun
  BundleRows active_; // of the group
  std::array<BundleRows, RayTile::kLevels> parts_; // of a slab: of bundles of a level
  RayRows rays_;                                   // of a slab
  std::vector<std::uint32_t> left_;                // what needs a closer look
  std::vector<kernels::RaySlab> undecided_;
};

} // namespace pcl_semantic
