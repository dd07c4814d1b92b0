// SPDX-License-Identifier: BSD-3-Clause
#include "temporary_name.h"

#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <system_error>

#include <unistd.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// Folders may be shared: a process is only known by its number on its own machine.
std::string
hostName()
{
  char name[65] = {};
  return ::gethostname(name, sizeof(name) - 1) == 0 ? name : "";
}

bool
isRunning(pid_t process)
{
  return ::kill(process, 0) == 0 || errno != ESRCH;
}

bool
isAbandoned(const std::string& name, const std::string& host)
{
  const std::string before = "." + host + ".";
  const std::size_t at = name.rfind(before);
  if (name.front() != '.' || at == std::string::npos || at == 0)
    return false;
  pid_t process = 0;
  const char* const end = name.data() + name.size();
  const auto number = std::from_chars(name.data() + at + before.size(), end, process);
  const std::string ending(number.ptr, end);
  const bool is_ours = ending == ".tmp" || ending == ".tmp-wal" ||
                       ending == ".tmp-shm" || ending == ".tmp-journal";
  return is_ours && process > 0 && !isRunning(process);
}

} // namespace

std::string
temporaryNameOf(const std::string& path)
{
  const fs::path folder = fs::path(path).parent_path();
  const std::string name = "." + fs::path(path).filename().string() + "." + hostName() +
                           "." + std::to_string(::getpid()) + ".tmp";
  return ((folder.empty() ? fs::path(".") : folder) / name).string();
}

void
removeAbandoned(const std::string& folder)
{
  const std::string host = hostName();
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    if (isAbandoned(entry.path().filename().string(), host))
      fs::remove(entry.path(), ignored);
  }
}

} // namespace pcl_semantic
