// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_semantic::tool {

/** \brief Opens a window on a map in the making: pcl_semantic_view, started as a
 * program of its own, which reads what MappingOutput::writeLive() writes. Nothing that
 * happens to a window, to its X server or to what draws touches the map, and a run
 * without a window does not load VTK. The window stays when this program has ended.
 * \param[in] folder that the map is written to; it need not be there yet
 * \param[in] images sequence in KITTI's layout whose pictures are shown; may be empty
 * \throws InvalidParameterException with the viewer's own words if it does not open */
void openLiveView(const std::string& folder, const std::string& images);

} // namespace pcl_semantic::tool
