// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/core/label_set.h>
#include <pcl_semantic/core/voxel_index.h>

#include <array>
#include <cstdint>
#include <vector>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief What is known of a place. */
enum class Occupancy { unknown, free, occupied };

/** \brief All that a map knows of one voxel. */
struct VoxelState {
  VoxelIndex index = VoxelIndex::Zero(); ///< global
  Occupancy occupancy = Occupancy::unknown;
  float log_odds = 0.0f;                ///< of being occupied; 0 if unknown
  std::array<std::uint8_t, 3> colour{}; ///< mean red, green, blue; black if never seen
  std::uint32_t observations = 0;       ///< scans that hit the voxel
  Label label = kUnlabelled;            ///< MAP of \a refined
  std::vector<float> measured;          ///< L fused probabilities; all 0: no label
  std::vector<float> refined;           ///< the CRF's, else \a measured
  float entropy = 0.0f;                 ///< of \a refined [nat]; log L without a label
};

} // namespace pcl_semantic
