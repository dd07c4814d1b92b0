// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/run_tool.h"

namespace pcl_semantic {

/** \brief Whether runOnDisplay() can be used. */
inline bool
hasVirtualDisplay()
{
  return runShell("command -v xvfb-run && command -v xauth").code == 0;
}

/** \brief Runs a program on a display that nobody sees. A server that begins anew when
 * its last client leaves confuses xvfb-run, which then fails now and then. */
inline ToolResult
runOnDisplay(const std::string& program, const std::string& before = "")
{
  return runShell(before +
                  " xvfb-run -a -s '-screen 0 1280x1024x24 -nolisten tcp -noreset' " +
                  program + " 2>&1");
}

} // namespace pcl_semantic
