// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>
#include <pcl_semantic/map/semantic_voxel_map.h>

#include <memory>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief Writes a whole map into a new archive (see MapArchive).
 * \throws OutputException also if the file is there already */
void saveMap(const SemanticVoxelMap& map, const std::string& path);

/** \brief The map of an archive, in memory: it can grow, the file stays as it is. Its
 * window lies nowhere, and queries find nothing, until moveWindow() or a scan.
 * \throws BadInputException */
std::unique_ptr<SemanticVoxelMap> loadMap(const std::string& path);

} // namespace pcl_semantic
