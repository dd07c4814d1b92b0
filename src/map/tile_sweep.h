/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

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
 * outermost rays show that all of it stays in one voxel, or in two that share a side,
 * these are crossed and no other. Bundles of which that is not certain are taken
 * apart, in the end into rays; what single precision cannot decide of a ray goes to
 * the exact traversal. */
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
  // Bundles side by side, as the loops want them, with their origin in the tile.
  struct Active {
    std::array<std::vector<float>, 12> slopes; // of BundleView, in its order
    std::vector<std::int32_t> reach;
    std::vector<const RayBundle*> bundle;
    std::size_t count = 0;

    void add(const RayBundle& added);

    kernels::BundleView view() const;
  };

  // Slabs of one layer of blocks: first to last, outward.
  struct Group {
    int first, last;
    int block; // along the axis
  };

  bool beginGroup(const Group& group);

  float enterDistance(int slab) const;

  kernels::SlabView viewOf(int number);

  void crossAllRays(const Group& group);

  void crossBundles(const kernels::SlabView& slab, const Active& bundles, int level);

  void crossRays(const kernels::SlabView& slab);

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
  int level_ = 0;                              // of the bundles of a group; -1: rays
  int groups_ = 0;                             // that were begun
  Active active_;                              // of the group
  std::array<Active, RayTile::kLevels> parts_; // of a slab: those of bundles of a level
  std::vector<std::uint32_t> left_;            // rays that need a closer look
  std::vector<kernels::BundleLeft> bundles_left_;
  std::vector<kernels::CornerRays> corners_;
  std::vector<kernels::RaySlab> undecided_;
  std::vector<kernels::RayRange> ranges_; // of rays of a slab
};

} // namespace pcl_semantic
