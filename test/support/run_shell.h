// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

#include <sys/wait.h>

namespace pcl_semantic {

/** \brief Exit code and output of a program, errors included. */
struct ToolResult {
  int code = -1; ///< exit code; -1 after a signal
  std::string text;
};

/** \brief Runs a shell command. */
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

} // namespace pcl_semantic
