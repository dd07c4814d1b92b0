// SPDX-License-Identifier: BSD-3-Clause
#include "live_view.h"
#include "core/fail.h"

#include <filesystem>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

namespace pcl_semantic::tool {

namespace {

// Starts a program that prints to a pipe. Returns whether it was started.
bool
start(std::vector<std::string> words, int pipe)
{
  std::vector<char*> arguments;
  for (std::string& word : words)
    arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t streams;
  posix_spawn_file_actions_init(&streams);
  posix_spawn_file_actions_addopen(&streams, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
    posix_spawn_file_actions_adddup2(&streams, pipe, stream);
  pid_t process = 0;
  const int error =
      posix_spawn(&process, arguments[0], &streams, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&streams);
  return error == 0;
}

std::string
firstLine(int pipe)
{
  std::string line;
  for (char c = 0; read(pipe, &c, 1) == 1 && c != '\n';)
    line += c;
  return line;
}

} // namespace

void
openLiveView(const std::string& folder, const std::string& images)
{
  const std::string program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() /
      "pcl_semantic_view";
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    badParameter("--view: no pipe can be opened");
  std::vector<std::string> words = {program, folder, "--follow"};
  if (!images.empty())
    words.insert(words.end(), {"--images", images});
  const bool is_started = start(std::move(words), ends[1]);
  close(ends[1]);
  const std::string line = is_started ? firstLine(ends[0]) : "";
  if (line == "following: " + folder)
    return; // the pipe stays open, so that the viewer can print
  close(ends[0]);
  badParameter("--view: ",
               !is_started
                   ? program + " cannot be started; is pcl_semantic_view installed?"
               : line.empty() ? "the window did not open"
                              : line);
}

} // namespace pcl_semantic::tool
