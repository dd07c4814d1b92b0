// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_arguments.h"
#include "messages.h"

#include <vector>

namespace pcl_semantic::tool {

/** \brief Maps a recording until its end or an interrupt (interrupted()).
 * \return what was written \throws as a tool's body */
Results mapRecorded(const MapArguments& arguments);

/** \brief The runs that map a recording in submaps (--submap-every): each is a run of
 * its own over a stretch of the frames, named after the first of them.
 * \throws as a tool's body */
std::vector<MapArguments> submapsOf(const MapArguments& arguments);

} // namespace pcl_semantic::tool
