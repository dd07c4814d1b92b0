// SPDX-License-Identifier: BSD-3-Clause
#include "object_merge.h"

#include "map/block_reader.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace pcl_semantic {

namespace {

// The voxels around a voxel, and itself.
template <typename Visit>
void
forEachNear(const VoxelIndex& voxel, Visit&& visit)
{
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        visit(VoxelIndex(voxel + VoxelIndex(x, y, z)));
}

VoxelIndex
voxelWith(const Eigen::Vector3d& position)
{
  return position.array().floor().matrix().cast<int>();
}

// The voxels that copy those of an object, as in MovedArchive: a voxel copies the one
// that contains its transformed centre.
void
moveVoxels(MapObject& object, const Eigen::Isometry3d& motion)
{
  const Eigen::Isometry3d inverse = motion.inverse();
  const auto centre = [](const VoxelIndex& voxel) { return centreOf(voxel, 1.0); };
  std::vector<VoxelIndex> voxels;
  std::vector<std::uint32_t> observations;
  for (std::size_t i = 0; i < object.voxels.size(); ++i)
    forEachNear(voxelWith(motion * centre(object.voxels[i])),
                [&](const VoxelIndex& moved) {
                  if (voxelWith(inverse * centre(moved)) != object.voxels[i])
                    return;
                  voxels.push_back(moved);
                  observations.push_back(object.observations[i]);
                });
  object.voxels = std::move(voxels);
  object.observations = std::move(observations);
  object.summary.motion = motion.linear() * object.summary.motion;
}

class Merge {
public:
  void
  add(std::vector<MapObject> objects)
  {
    std::vector<std::size_t> places(objects.size());
    const std::map<std::size_t, std::size_t> partners = match(objects);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      const auto partner = partners.find(i);
      places[i] = partner == partners.end() ? merged_.size() : partner->second;
      if (partner == partners.end())
        merged_.emplace_back();
      join(objects[i], merged_[places[i]]);
    }
    for (std::size_t i = 0; i < objects.size(); ++i)
      addVoxels(objects[i], places[i]);
  }

  std::vector<MapObject>
  result()
  {
    for (const auto& [voxel, cell] : cells_)
      merged_[cell.first].voxels.push_back(voxel);
    merged_.erase(std::remove_if(merged_.begin(), merged_.end(),
                                 [](const auto& each) { return each.voxels.empty(); }),
                  merged_.end());
    std::uint32_t number = 0;
    for (MapObject& object : merged_) {
      object.number = ++number;
      std::sort(object.voxels.begin(), object.voxels.end(), VoxelIndexLess());
      for (const VoxelIndex& voxel : object.voxels)
        object.observations.push_back(cells_.at(voxel).second);
    }
    return std::move(merged_);
  }

private:
  // The merged object that each object joins, if any.
  std::map<std::size_t, std::size_t>
  match(const std::vector<MapObject>& objects) const
  {
    std::vector<std::tuple<std::ptrdiff_t, std::size_t, std::size_t>> pairs;
    for (std::size_t i = 0; i < objects.size(); ++i)
      if (!objects[i].summary.moving)
        for (const auto& [place, count] : sharedBy(objects[i]))
          pairs.emplace_back(-std::ptrdiff_t(count), place, i); // most shared first
    std::sort(pairs.begin(), pairs.end());
    std::map<std::size_t, std::size_t> partners;
    std::set<std::size_t> taken;
    for (const auto& [count, place, i] : pairs)
      if (partners.count(i) == 0 && taken.insert(place).second)
        partners[i] = place;
    return partners;
  }

  // By merged still object of its class, the number of voxels that are this object's,
  // or have such neighbours.
  std::map<std::size_t, std::size_t>
  sharedBy(const MapObject& object) const
  {
    std::map<std::size_t, std::size_t> shared;
    for (const VoxelIndex& voxel : object.voxels) {
      std::set<std::size_t> near;
      forEachNear(voxel, [&](const VoxelIndex& other) {
        if (const auto cell = cells_.find(other); cell != cells_.end())
          near.insert(cell->second.first);
      });
      for (const std::size_t place : near)
        if (merged_[place].label == object.label && !merged_[place].summary.moving)
          ++shared[place];
    }
    return shared;
  }

  static void
  join(const MapObject& object, MapObject& merged)
  {
    if (merged.label == kUnlabelled) { // new
      merged.label = object.label;
      merged.summary = object.summary;
      return;
    }
    ObjectTrack& track = merged.summary;
    track.first_frame = std::min(track.first_frame, object.summary.first_frame);
    track.last_frame = std::max(track.last_frame, object.summary.last_frame);
    track.frames += object.summary.frames;
  }

  void
  addVoxels(const MapObject& object, std::size_t place)
  {
    for (std::size_t i = 0; i < object.voxels.size(); ++i) {
      const auto [cell, is_new] = cells_.try_emplace(object.voxels[i], place, 0);
      if (cell->second.first == place)
        cell->second.second += object.observations[i];
    }
  }

  // The index in merged_, and the observations.
  using Cell = std::pair<std::size_t, std::uint32_t>;

  std::vector<MapObject> merged_;
  std::unordered_map<VoxelIndex, Cell, VoxelIndexHash> cells_;
};

} // namespace

MapObjects
mergeObjects(const std::vector<PlacedObjects>& maps)
{
  MapObjects result;
  Merge merge;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    std::vector<MapObject> objects = maps[i].objects.objects;
    if (maps[i].motion.matrix() != Eigen::Matrix4d::Identity())
      for (MapObject& object : objects)
        moveVoxels(object, maps[i].motion);
    merge.add(std::move(objects));
    const std::size_t min_voxels = maps[i].objects.min_voxels;
    result.min_voxels = i == 0 ? min_voxels : std::min(result.min_voxels, min_voxels);
  }
  result.objects = merge.result();
  result.last_number = std::uint32_t(result.objects.size());
  return result;
}

VoxelCloud
voxelsAround(const MapReader& map, const MapObject& object)
{
  std::set<VoxelIndex, VoxelIndexLess> reached;
  for (const VoxelIndex& voxel : object.voxels)
    reached.insert(blockOf(voxel));
  const std::vector<VoxelIndex> order(reached.begin(), reached.end());
  const auto read = map.get(order);
  std::vector<std::pair<VoxelIndex, const VoxelBlock*>> blocks;
  for (std::size_t i = 0; i < order.size(); ++i)
    if (read[i])
      blocks.emplace_back(order[i], read[i].get());
  const ArchiveHeader& header = map.header();
  return BlockReader(header.label_set.size(), header.parameters)
      .readAll(blocks, map.state().cloud_origin);
}

void
keepVisible(const MapReader& map, MapObjects& objects)
{
  for (MapObject& object : objects.objects) {
    const VoxelCloud voxels = voxelsAround(map, object);
    std::unordered_map<VoxelIndex, std::uint32_t, VoxelIndexHash> labels;
    for (std::size_t i = 0; i < voxels.size(); ++i)
      labels.emplace(voxels.indices[i], (*voxels.cloud)[i].label);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < object.voxels.size(); ++i) {
      const auto found = labels.find(object.voxels[i]);
      if (found == labels.end() || found->second != object.label)
        continue;
      object.voxels[kept] = object.voxels[i];
      object.observations[kept++] = object.observations[i];
    }
    object.voxels.resize(kept);
    object.observations.resize(kept);
  }
  auto& all = objects.objects;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const MapObject& object) {
                             return object.voxels.size() < objects.min_voxels;
                           }),
            all.end());
}

} // namespace pcl_semantic
