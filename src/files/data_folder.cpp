/*
 * SPDX-License-Identifier: BSD-3-Clause
 *
 * Part of pcl_semantic: semantic 3D occupancy mapping for PCL.
 */

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/data_folder.h>

#include <filesystem>
#include <system_error>

namespace pcl_semantic {

namespace fs = std::filesystem;

std::string
findDataFile(const std::string& name)
{
  std::error_code error;
  const fs::path programs = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* folder : {"../share/pcl_semantic", "../../data"}) {
    const fs::path path = (programs / folder / name).lexically_normal();
    if (fs::exists(path, error))
      return path.string();
  }
  PCL_THROW_EXCEPTION(BadInputException,
                      name << ": is not among the data of this installation");
}

} // namespace pcl_semantic
