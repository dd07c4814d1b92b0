// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <cstddef>
#include <fstream>
#include <functional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A file that appears under its name either complete or not at all.
 *
 * Output goes to a temporary name in the same folder; commit() flushes it to disk and
 * renames it. Without commit() the temporary file is removed and an existing file stays
 * unchanged. */
class AtomicFile {
public:
  /** \throws OutputException if the folder cannot be written */
  explicit AtomicFile(const std::string& path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  std::ostream&
  stream()
  {
    return stream_;
  }

  /** \throws OutputException if any output did not reach the disk */
  void commit();

private:
  std::string path_;
  std::string temporary_path_;
  std::ofstream stream_;
  int lock_ = -1; ///< descriptor of the lock that marks the temporary file as in use
};

/** \brief Flushes a file name to disk, if its folder is readable. */
void synchronizeFolderOf(const std::string& path);

/** \brief Writes a file of \a size bytes through AtomicFile.
 * \throws OutputException if the file cannot be written */
void writeBytes(const std::string& path, const void* bytes, std::size_t size);

/** \brief Writes a text file through AtomicFile.
 * \throws OutputException if the file cannot be written */
void writeTextFile(const std::string& path, const std::string& text);

/** \brief Makes a folder and its parents, checks that it is writable, and removes
 * temporary files of AtomicFile that killed processes left there.
 * \throws OutputException if the folder cannot be made or is not writable */
void makeOutputFolder(const std::string& path);

/** \brief Removes the files of a folder that are named by a frame number and \a
 * extension (`000012.png`).
 * \param[in] is_removed selects frames; null = all
 * \throws OutputException if a file cannot be removed */
void removeFrameFiles(const std::string& folder, const std::string& extension,
                      const std::function<bool(int frame)>& is_removed = nullptr);

} // namespace pcl_semantic
