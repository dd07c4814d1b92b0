// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/map_parameters.h>
#include <pcl_semantic/map/ray_caster.h>
#include <pcl_semantic/map/semantic_voxel.h>
#include <pcl_semantic/map/voxel_fusion.h>

#include <array>
#include <cstdint>
#include <vector>

namespace pcl_semantic {

/** \brief Brings what one scan says into a block: one update of occupancy a voxel, a
 * hit wins over a miss; colours and labels of the voxels that were hit. */
class BlockUpdate {
public:
  /** \param[in] classes L */
  BlockUpdate(int classes, const MapParameters& parameters, const Scan& scan);

  /** \param[in] crossed voxels, see CrossedVoxels::layers
   * \param[in] first, last hits in the block, in any order
   * \return number of voxels that were hit */
  std::size_t run(const std::uint64_t* crossed, const RayHit* first, const RayHit* last,
                  VoxelBlock& block);

private:
  void sortByPlace(const RayHit* first, const RayHit* last);

  void updateOccupancy(const std::uint64_t* crossed, VoxelBlock& block) const;

  float weightOf(std::size_t begin, std::size_t end) const;

  void fuse(int place, std::size_t begin, std::size_t end, VoxelBlock& block);

  const int classes_;
  const OccupancyUpdate occupancy_;
  const bool per_ray_;
  const double voxel_size_;
  const Scan& scan_;
  VoxelMeasurement measurement_;
  std::array<std::uint64_t, CrossedVoxels::kWords> hit_{}; // a bit a voxel
  std::array<std::uint32_t, kBlockVoxels> end_{};          // of its points, by voxel
  std::vector<std::uint32_t> points_;                      // by voxel
};

} // namespace pcl_semantic
