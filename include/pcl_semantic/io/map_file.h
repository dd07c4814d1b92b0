// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/semantic_voxel_map.h>
#include <pcl_semantic/things/map_objects.h>

#include <memory>
#include <optional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes a whole map into a new archive (see MapArchive).
 * \param[in] objects of the map, if it has any: ObjectTracker::objects()
 * \throws OutputException also if the file exists */
void saveMap(const SemanticVoxelMap& map, const std::string& path,
             const std::optional<MapObjects>& objects = std::nullopt);

/** \brief Loads the map of an archive into memory: the map can grow, the file stays
 * unchanged. Its window is empty until moveWindow() or a scan.
 * \throws BadInputException if the file is no archive, or is damaged */
std::unique_ptr<SemanticVoxelMap> loadMap(const std::string& path);

} // namespace pcl_semantic
