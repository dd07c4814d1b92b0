// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace pcl_semantic::tool {

/** \brief Whether an X server with OpenGL is available. VTK ends the program without
 * one. */
bool hasDisplay();

/** \brief Restarts this program with the same arguments on a virtual display, by
 * xvfb-run.
 * \throws InvalidParameterException that names the missing program; does not return
 * otherwise */
[[noreturn]] void restartOnVirtualDisplay(char** argv);

} // namespace pcl_semantic::tool
