// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/label_distributions.h>
#include <pcl_semantic/io/map_archive.h>

#include <array>
#include <cmath>
#include <map>

namespace pcl_semantic {

/** \brief Agreement of the voxels that are known in two archives. */
struct Agreement {
  double occupancy = 0.0;   ///< fraction with the same state, free or occupied
  double labels = 0.0;      ///< fraction with the same label, of those occupied in both
  std::size_t occupied = 0; ///< number of voxels occupied in both
  double near = 0.0; ///< fraction of one map's occupied voxels with a voxel of the same
                     ///< label at most one voxel away in the other
};

inline Agreement
agreementOf(const std::string& path, const std::string& other)
{
  const auto knownIn = [](const std::string& file) {
    const MapArchive archive(file, ArchiveAccess::read);
    const auto& fusion = archive.header().parameters.fusion;
    const int classes = archive.header().label_set.size();
    const auto least =
        std::log(fusion.occupied_probability / (1.0 - fusion.occupied_probability));
    std::map<std::array<int, 3>, int> known; // -1 = free, else the label
    archive.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
      for (int offset = 0; offset < kBlockVoxels; ++offset) {
        const auto log_odds = block.log_odds[std::size_t(offset)];
        if (log_odds == kUnknown)
          continue;
        const VoxelIndex voxel = voxelAt(index, offset);
        const int record = block.recordAt(offset);
        const bool is_occupied = record >= 0 && log_odds * kLogOddsUnit > least;
        known[{voxel.x(), voxel.y(), voxel.z()}] =
            is_occupied
                ? int(mapLabel(block.refined.data() + record * classes, classes))
                : -1;
      }
    });
    return known;
  };
  const auto a = knownIn(path), b = knownIn(other);
  const auto hasNear = [&](const std::array<int, 3>& voxel, int label) {
    for (int i = 0; i < 27; ++i) {
      const auto found = b.find(
          {voxel[0] + i % 3 - 1, voxel[1] + i / 3 % 3 - 1, voxel[2] + i / 9 - 1});
      if (found != b.end() && found->second == label)
        return true;
    }
    return false;
  };
  std::size_t both = 0, same = 0, occupied = 0, same_label = 0, all = 0, near = 0;
  for (const auto& [voxel, state] : a) {
    all += state >= 0;
    near += state >= 0 && hasNear(voxel, state);
    if (const auto found = b.find(voxel); found != b.end()) {
      ++both;
      same += (state < 0) == (found->second < 0);
      if (state < 0 || found->second < 0)
        continue;
      ++occupied;
      same_label += state == found->second;
    }
  }
  return {double(same) / double(both), double(same_label) / double(occupied), occupied,
          double(near) / double(all)};
}

} // namespace pcl_semantic
