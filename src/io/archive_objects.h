// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "archive_database.h"

#include <pcl_semantic/things/map_objects.h>

#include <cstdint>
#include <optional>
#include <vector>

namespace pcl_semantic {

/** \brief Writes the objects of a map into its archive: an entry for each changed
 * object, and `objects` with the numbers of all. */
void writeArchiveObjects(ArchiveDatabase& database, const MapObjects& objects);

/** \brief The numbers of all objects, and everything that they have in common. */
struct ArchiveObjectList {
  MapObjects common; ///< without objects
  std::vector<std::uint32_t> numbers;
};

/** \throws BadInputException */
ArchiveObjectList decodeObjectList(const Bytes& bytes);

/** \brief The entry of an object, without its name. */
Bytes encodeObject(const MapObject& object);

/** \throws BadInputException */
MapObject decodeObject(const Bytes& bytes);

/** \brief Reads the objects of a map; nothing if it was mapped without objects.
 * \param[in] classes of the map
 * \throws BadInputException */
std::optional<MapObjects> readArchiveObjects(ArchiveDatabase& database, int classes);

} // namespace pcl_semantic
