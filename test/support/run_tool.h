// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/kitti11.h"
#include "support/served_program.h"
#include "support/thrown_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace pcl_semantic {

/** \brief Shell prefix that starts a program as a new process, for the limits of that
 * process or for its time. */
constexpr const char* kStartedAnew = ":;";

/** \brief Runs a program of the build: "evaluate --help" is pcl_semantic_evaluate.
 * \param[in] before shell commands before it: "ulimit -v 99999;"; without any, a loaded
 * program may run it */
inline ToolResult
runTool(const std::string& arguments, const std::string& before = "")
{
  return before.empty() && isPlain(arguments)
             ? runServed(arguments)
             : runShell(before + " " + shellCommandOf(arguments));
}

/** \brief Runs a program that must succeed. \return its output */
inline std::string
succeed(const std::string& arguments, const std::string& before = "")
{
  const ToolResult result = runTool(arguments, before);
  EXPECT_EQ(result.code, 0) << arguments << "\n" << result.text;
  return result.text;
}

/** \brief Runs a program and EXPECTs its exit code and one line with its name and the
 * error. */
inline void
expectFails(const std::string& arguments, int code, const std::string& says)
{
  SCOPED_TRACE(arguments);
  const ToolResult result = runTool(arguments);
  EXPECT_EQ(result.code, code) << result.text;
  EXPECT_TRUE(holds(result.text, says));
  const std::string program =
      "pcl_semantic_" + arguments.substr(0, arguments.find(' ')) + ": ";
  EXPECT_EQ(result.text.rfind(program, 0), 0u) << result.text;
  EXPECT_EQ(std::count(result.text.begin(), result.text.end(), '\n'), 1) << result.text;
}

/** \brief The beginning of a command that maps a sequence with its stored labels. */
inline std::string
mapOf(const std::string& street)
{
  return "map " + street + " --labels " + street + "/labels";
}

/** \brief Whether runOnDisplay() is available. */
inline bool
hasVirtualDisplay()
{
  return runShell("command -v xvfb-run && command -v xauth").code == 0;
}

/** \brief Runs a program on a virtual display. The server must not restart after its
 * last client, because xvfb-run then fails sometimes. */
inline ToolResult
runOnDisplay(const std::string& program, const std::string& before = "")
{
  return runShell(before +
                  " xvfb-run -a -s '-screen 0 1280x1024x24 -nolisten tcp -noreset' " +
                  program + " 2>&1");
}

} // namespace pcl_semantic
