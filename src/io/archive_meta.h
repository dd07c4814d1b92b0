// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "archive_database.h"
#include "block_index_set.h"

#include <pcl_semantic/io/archive_header.h>

namespace pcl_semantic {

/** \brief What a map is; at its place in the archive. \throws BadInputException */
ArchiveHeader readHeader(ArchiveDatabase& database);

void writeHeader(ArchiveDatabase& database, const ArchiveHeader& header);

/** \throws BadInputException */
ArchiveState readState(ArchiveDatabase& database);

void writeState(ArchiveDatabase& database, const ArchiveState& state);

/** \brief Which blocks there are. A block whose row is lost would look like one that
 * never was: the keys have to be those that were committed, in order.
 * \throws BadInputException */
BlockIndexSet readBlockKeys(ArchiveDatabase& database, const ArchiveState& state);

/** \brief Whether blocks are those that were committed.
 * \throws BadInputException */
void checkBlockKeys(const std::string& path, const BlockIndexSet& blocks,
                    const ArchiveState& state);

/** \brief Whether the frames are as many as were committed.
 * \throws BadInputException */
void checkFrameCount(ArchiveDatabase& database, const ArchiveState& state);

} // namespace pcl_semantic
