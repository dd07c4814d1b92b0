/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#pragma once

#include <cstdio>
#include <string>

#include <sys/wait.h>

namespace pcl_semantic {

/** \brief How a program ended and what it printed, errors included. */
struct ToolResult {
  int code = -1; ///< exit code; -1 if it died of a signal
  std::string text;
};

/** \brief Runs a program of the build: "evaluate --help" is pcl_semantic_evaluate. */
inline ToolResult
runTool(const std::string& arguments)
{
  const std::string command =
      std::string(PCL_SEMANTIC_BINARY_DIR) + "/bin/pcl_semantic_" + arguments + " 2>&1";
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

} // namespace pcl_semantic
