// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/things/map_objects.h>

#include <algorithm>
#include <map>
#include <utility>

namespace pcl_semantic {

ObjectLookup::ObjectLookup(MapObjects objects) : objects_(std::move(objects))
{
  for (std::size_t i = 0; i < objects_.objects.size(); ++i)
    if (const MapObject& object = objects_.objects[i];
        object.voxels.size() >= objects_.min_voxels)
      for (const VoxelIndex& voxel : object.voxels)
        of_.emplace(voxel, i);
}

std::vector<std::uint32_t>
ObjectLookup::numbers(const VoxelCloud& voxels) const
{
  std::vector<std::uint32_t> numbers(voxels.size(), 0);
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (const auto found = of_.find(voxels.indices[i]); found != of_.end()) {
      const MapObject& object = objects_.objects[found->second];
      if (object.label == (*voxels.cloud)[i].label)
        numbers[i] = object.number;
    }
  return numbers;
}

std::vector<ObjectSummary>
ObjectLookup::summarize(const VoxelCloud& voxels) const
{
  return summarizeObjects(voxels, [&](std::uint32_t number) -> const MapObject& {
    return *std::lower_bound(
        objects_.objects.begin(), objects_.objects.end(), number,
        [](const MapObject& object, std::uint32_t n) { return object.number < n; });
  });
}

std::vector<ObjectSummary>
summarizeObjects(const VoxelCloud& voxels,
                 const std::function<const MapObject&(std::uint32_t)>& object)
{
  std::map<std::uint32_t, pcl::Indices> members;
  for (std::size_t i = 0; i < voxels.size(); ++i)
    if (voxels.objects[i] != 0)
      members[voxels.objects[i]].push_back(pcl::index_t(i));
  const auto position = [&](std::size_t i) -> Eigen::Vector3d {
    return (*voxels.cloud)[i].getVector3fMap().cast<double>() + voxels.origin;
  };
  std::vector<ObjectSummary> summaries;
  for (const auto& [number, indices] : members) {
    summaries.push_back(summarizeObject(indices, position, voxels.refined));
    summaries.back().id = number;
    summaries.back().label = object(number).label;
    summaries.back().track = object(number).summary;
  }
  return summaries;
}

} // namespace pcl_semantic
