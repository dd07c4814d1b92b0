// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace pcl_semantic {

/** \brief An empty folder for a test, removed afterwards with its contents. */
class TemporaryFolder {
public:
  explicit TemporaryFolder(
      const std::filesystem::path& parent = std::filesystem::temp_directory_path())
  {
    std::string name = (parent / "pcl_semantic_XXXXXX").string();
    if (!::mkdtemp(name.data()))
      ADD_FAILURE() << "no temporary folder " << name;
    path_ = name;
  }

  ~TemporaryFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  /** \brief A parent folder in memory, if available, for tests that flush often. */
  static std::filesystem::path
  memory()
  {
    const std::filesystem::path shared = "/dev/shm";
    return std::filesystem::is_directory(shared)
               ? shared
               : std::filesystem::temp_directory_path();
  }

  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /** \brief The folder itself, or the path of \a name in it. */
  std::string
  path(const std::string& name = "") const
  {
    return name.empty() ? path_ : path_ + "/" + name;
  }

  /** \brief Writes \a bytes to a file. \return its path */
  std::string
  write(const std::string& name, const std::string& bytes) const
  {
    std::ofstream(path(name), std::ios::binary) << bytes;
    return path(name);
  }

  /** \brief Number of files and folders in it, hidden ones included. */
  std::size_t
  entries() const
  {
    return std::size_t(std::distance(std::filesystem::directory_iterator(path_),
                                     std::filesystem::directory_iterator()));
  }

private:
  std::string path_;
};

/** \brief The bytes of a file; fails the test if it cannot be read. */
inline std::string
bytesOf(const std::string& path)
{
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream.good()) << path;
  return {std::istreambuf_iterator<char>(stream), {}};
}

} // namespace pcl_semantic
