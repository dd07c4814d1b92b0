// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

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

/** \brief Shell command of a program of the build, errors in its output:
 * "evaluate --help" is pcl_semantic_evaluate. */
inline std::string
shellCommandOf(const std::string& arguments)
{
  return "exec " PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_" + arguments + " 2>&1";
}

/** \brief Whether shellWords() splits a command line as the shell would. */
inline bool
isPlain(const std::string& command)
{
  bool is_quoted = false;
  for (const char letter : command) {
    if (letter == '\'')
      is_quoted = !is_quoted;
    else if (!is_quoted && std::strchr("\"$&|;<>*?()~`\\#!{}[]\n\t", letter))
      return false;
  }
  return true;
}

/** \brief Splits a command line into words, some of them in single quotes. */
inline std::vector<std::string>
shellWords(const std::string& command)
{
  std::vector<std::string> words;
  bool is_quoted = false, is_word = false;
  for (const char letter : command) {
    if (letter == ' ' && !is_quoted) {
      is_word = false;
      continue;
    }
    if (!is_word)
      words.emplace_back();
    is_word = true;
    if (letter == '\'')
      is_quoted = !is_quoted;
    else
      words.back() += letter;
  }
  return words;
}

/** \brief A program of the build that loads its libraries once for many runs, each a
 * fork of the process (support/served_program.cpp). */
class ServedProgram {
public:
  /** \param[in] name "crf" is pcl_semantic_crf */
  explicit ServedProgram(const std::string& name)
      : path_(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_" + name)
  {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
      return;
    const pid_t child = ::fork();
    if (child == 0) {
      constexpr int requests = 3; // as in served_program.cpp
      ::dup2(ends[1], requests);
      ::fcntl(requests, F_SETFD, 0); // in case it already had this number
      ::setenv("LD_PRELOAD", library(), 1);
      ::setenv("OMP_WAIT_POLICY", "passive", 0); // many runs share the cores
      ::execl(path_.c_str(), path_.c_str(), nullptr);
      ::_exit(127);
    }
    ::close(ends[1]);
    socket_ = ends[0];
    child_ = child;
  }

  ~ServedProgram()
  {
    ::close(socket_);
    int status = 0;
    ::waitpid(child_, &status, 0);
  }

  ServedProgram(const ServedProgram&) = delete;
  ServedProgram& operator=(const ServedProgram&) = delete;

  /** \param[in] words of the command line without the program */
  ToolResult
  run(const std::vector<std::string>& words)
  {
    const std::string printed = folder_.path("printed");
    std::string text = printed + '\0' + path_ + '\0';
    for (const std::string& word : words)
      text += word + '\0';
    const auto size = std::uint32_t(text.size());
    text.insert(0, reinterpret_cast<const char*>(&size), sizeof(size));
    int status = -1;
    const bool is_done =
        ::write(socket_, text.data(), text.size()) == ssize_t(text.size()) &&
        ::read(socket_, &status, sizeof(status)) == sizeof(status);
    EXPECT_TRUE(is_done) << path_;
    return {is_done && WIFEXITED(status) ? WEXITSTATUS(status) : -1, bytesOf(printed)};
  }

  /** \brief Whether this is available: not with sanitizers. */
  static bool
  isThere()
  {
    return std::filesystem::exists(library());
  }

private:
  static const char*
  library()
  {
    return PCL_SEMANTIC_BINARY_DIR "/test/libpcl_semantic_served.so";
  }

  std::string path_;
  TemporaryFolder folder_;
  int socket_ = -1;
  pid_t child_ = -1;
};

/** \brief Runs a program of the build that is loaded already, if there is one, in one
 * thread at a time.
 * \param[in] arguments as in runTool(), without shell syntax except for single quotes
 */
inline ToolResult
runServed(const std::string& arguments)
{
  static std::mutex mutex;
  const std::unique_lock<std::mutex> lock(mutex, std::try_to_lock);
  if (!lock || !ServedProgram::isThere())
    return runShell(shellCommandOf(arguments));
  static std::map<std::string, ServedProgram> programs;
  std::vector<std::string> words = shellWords(arguments);
  const std::string name = words.at(0);
  words.erase(words.begin());
  return programs.try_emplace(name, name).first->second.run(words);
}

} // namespace pcl_semantic
