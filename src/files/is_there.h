// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace pcl_semantic {

/** \brief Whether a path exists; opening it may still fail, for example for a loop of
 * links. Does not throw, unlike std::filesystem::exists(). */
inline bool
isThere(const std::filesystem::path& path)
{
  std::error_code error;
  return std::filesystem::status(path, error).type() !=
         std::filesystem::file_type::not_found;
}

/** \brief Whether a path leads to a folder; does not throw. */
inline bool
isFolder(const std::filesystem::path& path)
{
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

} // namespace pcl_semantic
