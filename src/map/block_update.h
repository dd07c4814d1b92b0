// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "class_flags.h"
#include "ray_caster.h"
#include "voxel_fusion.h"

#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/map/map_parameters.h>

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Integrates one scan into a block: one occupancy update per voxel, in which a
 * hit wins over a miss, and colours and labels of the hit voxels. */
class BlockUpdate {
public:
  BlockUpdate(const LabelSet& label_set, const MapParameters& parameters,
              const Scan& scan);

  /** \param[in] crossed voxels, see CrossedVoxels::layers
   * \param[in] first, last hits in the block, in any order
   * \return number of hit voxels */
  std::size_t run(const std::uint64_t* crossed, const RayHit* first, const RayHit* last,
                  VoxelBlock& block);

private:
  void sortByOffset(const RayHit* first, const RayHit* last);

  void updateOccupancy(const std::uint64_t* crossed, VoxelBlock& block) const;

  float weightOf(std::size_t begin, std::size_t end) const;

  void fuse(int offset, std::size_t begin, std::size_t end, VoxelBlock& block);

  const int classes_;
  const ClassFlags dynamic_;
  const bool occupies_dynamic_;
  const OccupancyUpdate occupancy_;
  const bool per_ray_;
  const double voxel_size_;
  const LabelDeviations label_deviations_;
  const Scan& scan_;
  VoxelMeasurement measurement_;
  std::array<std::uint64_t, CrossedVoxels::kWords> hit_{}; // one bit per voxel
  std::array<std::uint32_t, kBlockVoxels> end_{};          // of its hits, by voxel
  std::vector<RayHit> hits_;                               // by voxel
};

/** \brief Counts every ray of a scan in the occupancy of its voxels, as in the paper.
 * Sequential, because the order of rays matters.
 * \param[in] scan that \a caster has cast last
 * \param[in,out] grid that the rays were cast through; contains all crossed blocks */
void countRays(const RayCaster& caster, const MapParameters& parameters,
               const Scan& scan, RayCaster::Grid& grid);

} // namespace pcl_semantic
