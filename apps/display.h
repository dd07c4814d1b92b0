// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_semantic::tool {

/** \brief Whether an X server answers that can draw with OpenGL. VTK ends the program
 * if there is none. */
bool hasDisplay();

/** \brief Starts this program again, with the same arguments, on a display that nobody
 * sees: xvfb-run's.
 * \throws InvalidParameterException that names what is missing; does not return
 * otherwise */
[[noreturn]] void restartOnVirtualDisplay(char** argv);

} // namespace pcl_semantic::tool
