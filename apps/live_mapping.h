// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "map_arguments.h"

namespace pcl_semantic::tool {

/** \brief Maps what comes until it ends or an interrupt comes, then finishes
 * the map and writes it. \return an exit code \throws as a tool's body */
int mapLive(const MapArguments& arguments);

} // namespace pcl_semantic::tool
