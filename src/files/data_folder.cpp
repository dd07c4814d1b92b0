// SPDX-License-Identifier: BSD-3-Clause
#include <pcl_semantic/files/data_folder.h>

#include "core/fail.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>
#include <vector>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// The folders of the running program and of this library; empty if unknown.
std::vector<fs::path>
homes()
{
  std::error_code error;
  std::vector<fs::path> folders = {
      fs::read_symlink("/proc/self/exe", error).parent_path()};
  static const char here = 0;
  Dl_info library;
  if (dladdr(&here, &library) != 0 && library.dli_fname != nullptr)
    folders.push_back(fs::canonical(library.dli_fname, error).parent_path());
  return folders;
}

} // namespace

std::string
findDataFile(const std::string& name)
{
  // relative to bin or lib; to lib/<architecture>; in a build
  const char* const folders[] = {"../share/pcl_semantic", "../../share/pcl_semantic",
                                 "../../data"};
  std::error_code error;
  for (const fs::path& home : homes())
    for (const char* folder : folders) {
      const fs::path path = (home / folder / name).lexically_normal();
      if (!home.empty() && fs::exists(path, error))
        return path.string();
    }
  badInput(name, ": is not among the data of this installation");
}

} // namespace pcl_semantic
