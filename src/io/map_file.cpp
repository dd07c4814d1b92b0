// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/io/map_file.h>

#include "archive_database.h"

#include <pcl_semantic/io/map_archive.h>

namespace pcl_semantic {

void
saveMap(const SemanticVoxelMap& map, const std::string& path,
        const std::optional<MapObjects>& objects)
{
  makeArchiveFile(path, [&](const std::string& temporary) {
    const auto archive = MapArchive::create(
        temporary, {map.labelSet(), map.parameters(), "saved: as a whole\n"});
    map.forEachBlock([&](const VoxelIndex& index, const VoxelBlock& block) {
      archive->put(index, block);
    });
    if (objects)
      archive->putObjects(*objects);
    ArchiveState state;
    state.cloud_origin = map.cloudOrigin();
    state.finished = true;
    archive->commit(state);
    archive->close();
  });
}

std::unique_ptr<SemanticVoxelMap>
loadMap(const std::string& path)
{
  const std::unique_ptr<MapReader> archive = MapReader::open(path);
  const auto store = std::make_shared<MemoryBlockStore>();
  archive->forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    store->put(index, block);
  });
  auto map = std::make_unique<SemanticVoxelMap>(archive->header().label_set,
                                                archive->header().parameters, store);
  map->setCloudOrigin(archive->state().cloud_origin);
  return map;
}

} // namespace pcl_semantic
