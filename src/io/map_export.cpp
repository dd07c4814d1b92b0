// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/map_export.h>

#include "core/label_number.h"

#include "map/block_reader.h"
#include "object_merge.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

namespace pcl_semantic {

namespace {

// Visits the blocks with occupied voxels, and these voxels as a cloud.
template <typename Visit>
void
forEachCloud(const MapReader& archive, const std::function<void()>& step, Visit&& visit)
{
  const ArchiveHeader& header = archive.header();
  const Eigen::Vector3d origin = archive.state().cloud_origin;
  const BlockReader reader(header.label_set.size(), header.parameters);
  archive.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    step();
    const std::size_t count = reader.countOccupied(block);
    if (count == 0)
      return;
    VoxelCloud voxels = reader.makeCloud(count, header.parameters.voxel_size, origin);
    reader.read(index, block, 0, voxels);
    visit(voxels);
  });
}

std::vector<bool>
select(const VoxelSelection& selection, const VoxelCloud& voxels)
{
  std::vector<bool> is_selected(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const Eigen::Array3d centre = centreOf(voxels.indices[i], voxels.voxel_size);
    const auto label = requireLabel((*voxels.cloud)[i].label);
    is_selected[i] =
        (centre >= selection.box.min().array()).all() &&
        (centre < selection.box.max().array()).all() &&
        (selection.labels.empty() ||
         std::count(selection.labels.begin(), selection.labels.end(), label) > 0);
  }
  return is_selected;
}

} // namespace

ArchiveExtent
archiveExtent(const MapReader& archive, const BlockProgress& progress)
{
  ArchiveExtent extent;
  std::size_t done = 0;
  const auto step = [&] {
    if (progress)
      progress(++done, archive.state().blocks);
  };
  forEachCloud(archive, step, [&](const VoxelCloud& voxels) {
    extent.voxels += voxels.size();
    for (const VoxelIndex& voxel : voxels.indices) {
      extent.box.extend(voxel.cast<double>() * voxels.voxel_size);
      extent.box.extend((voxel.cast<double>().array() + 1.0).matrix() *
                        voxels.voxel_size);
    }
  });
  return extent;
}

VoxelCloud
readVoxels(const MapReader& archive, const VoxelSelection& selection)
{
  VoxelCloud selected;
  selected.voxel_size = archive.header().parameters.voxel_size;
  selected.origin = archive.state().cloud_origin;
  forEachCloud(
      archive, [] {},
      [&](const VoxelCloud& voxels) {
        const std::vector<bool> is_selected = select(selection, voxels);
        for (std::size_t i = 0; i < voxels.size(); ++i)
          if (is_selected[i]) {
            selected.cloud->push_back((*voxels.cloud)[i]);
            selected.indices.push_back(voxels.indices[i]);
          }
      });
  return selected;
}

std::vector<ObjectSummary>
describeObjects(const MapReader& archive, const VoxelSelection& selection)
{
  const std::optional<MapObjects> objects = archive.objects();
  if (!objects)
    return {};
  const ObjectLookup lookup(*objects);
  const int classes = archive.header().label_set.size();
  VoxelCloud found; // the voxels of objects
  found.voxel_size = archive.header().parameters.voxel_size;
  found.origin = archive.state().cloud_origin;
  std::vector<float> probabilities; // of found
  for (const MapObject& object : objects->objects) {
    const VoxelCloud voxels = voxelsAround(archive, object);
    const std::vector<std::uint32_t> numbers = lookup.numbers(voxels);
    const std::vector<bool> is_selected = select(selection, voxels);
    for (std::size_t i = 0; i < voxels.size(); ++i) {
      if (numbers[i] != object.number || !is_selected[i])
        continue;
      found.cloud->push_back((*voxels.cloud)[i]);
      found.indices.push_back(voxels.indices[i]);
      found.objects.push_back(numbers[i]);
      const float* const column = voxels.refined.column(Eigen::Index(i));
      probabilities.insert(probabilities.end(), column, column + classes);
    }
  }
  found.refined = LabelDistributions(classes, Eigen::Index(found.size()));
  std::copy(probabilities.begin(), probabilities.end(), found.refined.matrix().data());
  return lookup.summarize(found);
}

std::size_t
exportVoxels(const MapReader& archive, const VoxelSelection& selection,
             const std::string& path, VoxelColour colour, const BlockProgress& progress,
             const std::vector<std::uint32_t>* planes)
{
  std::size_t done = 0;
  const auto step = [&] {
    if (progress)
      progress(++done, 2 * archive.state().blocks);
  };
  std::optional<ObjectLookup> lookup;
  if (std::optional<MapObjects> objects = archive.objects())
    lookup.emplace(std::move(*objects));
  std::size_t count = 0;
  bool has_colour = false;
  forEachCloud(archive, step, [&](const VoxelCloud& voxels) {
    const std::vector<bool> is_selected = select(selection, voxels);
    count += std::size_t(std::count(is_selected.begin(), is_selected.end(), true));
    has_colour = has_colour || hasColour(voxels);
  });
  if (colour == VoxelColour::measured && count > 0 && !has_colour)
    colour = VoxelColour::none;
  if (planes && planes->size() != count)
    badParameter("planes of ", planes->size(), " voxels, expected ", count);
  VoxelCloudWriter writer(path, archive.header().label_set, colour, count,
                          archive.header().parameters.voxel_size,
                          archive.state().cloud_origin,
                          {lookup.has_value(), planes != nullptr});
  std::size_t next = 0; // of planes
  forEachCloud(archive, step, [&](VoxelCloud& voxels) {
    if (lookup)
      voxels.objects = lookup->numbers(voxels);
    const std::vector<bool> is_selected = select(selection, voxels);
    if (planes) {
      voxels.planes.assign(voxels.size(), 0);
      for (std::size_t i = 0; i < voxels.size(); ++i)
        if (is_selected[i])
          voxels.planes[i] = (*planes)[next++];
    }
    writer.write(voxels, is_selected);
  });
  writer.commit();
  return count;
}

} // namespace pcl_semantic
