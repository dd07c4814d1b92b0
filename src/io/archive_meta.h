/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include "archive_database.h"

#include <pcl_semantic/io/archive_header.h>

namespace pcl_semantic {

/** \brief What a map is; at its place in the archive. \throws BadInputException */
ArchiveHeader readHeader(ArchiveDatabase& database);

void writeHeader(ArchiveDatabase& database, const ArchiveHeader& header);

/** \throws BadInputException */
ArchiveState readState(ArchiveDatabase& database);

void writeState(ArchiveDatabase& database, const ArchiveState& state);

/** \brief Whether the frames are as many as were committed.
 * \throws BadInputException */
void checkFrameCount(ArchiveDatabase& database, const ArchiveState& state);

} // namespace pcl_semantic
