// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_semantic::tool {

/** \brief Opens a window on a growing map: pcl_semantic_view as a separate process,
 * which reads the output of MappingOutput::writeLive(). Failures of the window, its X
 * server or its rendering cannot affect the map, and a run without a window does not
 * load VTK. The window stays open after this program ends.
 * \param[in] folder of the map; it may not exist yet
 * \param[in] images sequence in KITTI's layout whose images are shown; may be empty
 * \throws InvalidParameterException with the viewer's message if it does not open */
void openLiveView(const std::string& folder, const std::string& images);

} // namespace pcl_semantic::tool
