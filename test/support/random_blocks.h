// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/map/semantic_voxel.h>

#include <algorithm>
#include <random>
#include <vector>

namespace pcl_semantic {

/** \brief A block with any values that a map may hold, in \a records voxels of random
 * places, in random order. */
inline VoxelBlock
makeRandomBlock(std::size_t records, int classes, unsigned seed)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> log_value(-9.2f, 0.0f), share(0.0f, 1.0f);
  VoxelBlock block;
  for (StoredLogOdds& value : block.log_odds)
    value = random() % 4 == 0 ? kUnknown : StoredLogOdds(int(random() % 28000) - 14000);
  std::vector<int> places(kBlockVoxels);
  for (int i = 0; i < kBlockVoxels; ++i)
    places[std::size_t(i)] = i;
  std::shuffle(places.begin(), places.end(), random);
  for (std::size_t i = 0; i < records; ++i) {
    const int record = block.makeRecord(places[i], classes);
    VoxelRecord& values = block.records[std::size_t(record)];
    for (std::uint32_t& sum : values.colour_sum)
      sum = std::uint32_t(random());
    values.colour_count = std::uint32_t(random()) >> 10;
    values.observations = std::uint32_t(random()) >> (random() % 32);
    values.label_observations = values.observations / 2;
    for (std::uint16_t& coordinate : values.position)
      coordinate = std::uint16_t(random());
    for (int k = 0; k < classes; ++k) {
      block.measured[std::size_t(record * classes + k)] =
          k == record % classes ? 0.0f : log_value(random);
      block.refined[std::size_t(record * classes + k)] =
          record % 3 == 0 ? 0.0f : share(random);
    }
  }
  return block;
}

/** \brief Whether two blocks hold the same values, bit by bit, in whatever order their
 * records lie. */
inline bool
areSameBlocks(const VoxelBlock& a, const VoxelBlock& b, int classes)
{
  if (a.log_odds != b.log_odds || a.records.size() != b.records.size())
    return false;
  const auto same = [&](const std::vector<float>& x, int i, const std::vector<float>& y,
                        int j) {
    return std::equal(x.begin() + i * classes, x.begin() + (i + 1) * classes,
                      y.begin() + j * classes);
  };
  for (int place = 0; place < kBlockVoxels; ++place) {
    const int i = a.recordAt(place), j = b.recordAt(place);
    if ((i == VoxelBlock::kNoRecord) != (j == VoxelBlock::kNoRecord))
      return false;
    if (i == VoxelBlock::kNoRecord)
      continue;
    const VoxelRecord &p = a.records[std::size_t(i)], &q = b.records[std::size_t(j)];
    if (p.colour_sum != q.colour_sum || p.colour_count != q.colour_count ||
        p.observations != q.observations ||
        p.label_observations != q.label_observations || p.position != q.position ||
        !same(a.measured, i, b.measured, j) || !same(a.refined, i, b.refined, j))
      return false;
  }
  return true;
}

} // namespace pcl_semantic
