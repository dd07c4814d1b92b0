// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/thrown_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include <sys/wait.h>

namespace pcl_semantic {

/** \brief Exit code and output of a program, errors included. */
struct ToolResult {
  int code = -1; ///< exit code; -1 after a signal
  std::string text;
};

inline ToolResult
runShell(const std::string& command)
{
  ToolResult result;
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (!pipe)
    return result;
  char buffer[4096];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof(buffer), pipe)) > 0;)
    result.text.append(buffer, n);
  const int status = pclose(pipe);
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

/** \brief Runs a program of the build: "evaluate --help" is pcl_semantic_evaluate.
 * \param[in] before shell commands before it: "ulimit -v 99999;" */
inline ToolResult
runTool(const std::string& arguments, const std::string& before = "")
{
  return runShell(before + " exec " PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_" +
                  arguments + " 2>&1");
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
