// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_arguments.h"
#include "messages.h"

#include <pcl_semantic/pipeline/run_description.h>

#include <vector>

namespace pcl_semantic::tool {

/** \brief Maps a recording until its end or an interrupt (interrupted()).
 *
 * A submap of a fleet (`archive_only`) that is there is kept if it holds what would be
 * made now; made further if it is a part of that; else replaced.
 * \return what was written; nothing if it was kept \throws as a tool's body */
Results mapRecorded(const MapArguments& arguments);

/** \brief Removes an archive and what SQLite has put beside it, if it is there.
 * \throws OutputException */
void removeArchive(const std::string& path);

/** \brief A recording in submaps. */
struct SubmapRuns {
  std::vector<MapArguments> each;
  MappingRun whole;                 ///< of all of them
  std::vector<FrameTime> anchors{}; ///< of each, see submapMotion()
};

/** \brief The runs that map a recording in submaps (--submap-every): each is a run of
 * its own over a stretch of the frames, named after the first of them.
 * \throws as a tool's body */
SubmapRuns submapsOf(const MapArguments& arguments);

/** \brief One of them.
 * \param[in] frames "A:B", as submapsOf() has them */
MapArguments submapOf(const MapArguments& arguments, const std::string& frames);

} // namespace pcl_semantic::tool
