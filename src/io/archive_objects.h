// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "archive_database.h"

#include <pcl_semantic/things/map_objects.h>

#include <cstdint>
#include <map>
#include <optional>

namespace pcl_semantic {

/** \brief Writes the objects of a map into its archive: an entry for each object, and
 * `objects` with their numbers. Entries that would not change are not written. */
class ArchiveObjectWriter {
public:
  void write(ArchiveDatabase& database, const MapObjects& objects);

private:
  std::map<std::uint32_t, std::uint64_t> written_; // digests of the entries
};

/** \brief The entry of an object, without its name. */
Bytes encodeObject(const MapObject& object);

/** \throws BadInputException */
MapObject decodeObject(const Bytes& bytes);

/** \brief Reads the objects of a map; nothing if it was mapped without objects.
 * \param[in] classes of the map
 * \throws BadInputException */
std::optional<MapObjects> readArchiveObjects(ArchiveDatabase& database, int classes);

} // namespace pcl_semantic
