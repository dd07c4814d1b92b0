// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pcl_semantic/core/export.h>

#include <cstddef>
#include <fstream>
#include <functional>
#include <string>

namespace PCL_SEMANTIC_EXPORT pcl_semantic {

/** \brief A file that appears under its name whole or not at all.
 *
 * What is written goes to a temporary name in the same folder; commit() brings it to
 * the disk and renames it. Without commit() the temporary file is removed and whatever
 * had the final name before stays. */
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

  /** \throws OutputException if anything written so far did not reach the disk */
  void commit();

private:
  std::string path_;
  std::string temporary_path_;
  std::ofstream stream_;
  int lock_ = -1; ///< descriptor of the lock that shows other processes a writer
};

/** \brief Brings the name of a file to the disk, where its folder may be read. */
void synchronizeFolderOf(const std::string& path);

/** \brief Writes a file of \a size bytes through AtomicFile. \throws OutputException */
void writeBytes(const std::string& path, const void* bytes, std::size_t size);

/** \brief Likewise a text file. \throws OutputException */
void writeTextFile(const std::string& path, const std::string& text);

/** \brief Makes a folder and its parents, checks that a file can be written there, and
 * removes the temporary files of AtomicFile that killed processes have left there.
 * \throws OutputException */
void makeOutputFolder(const std::string& path);

/** \brief Removes the files of a folder that are named by a frame number and
 * \a extension (`000012.png`).
 * \param[in] is_removed which frames' files; null = all
 * \throws OutputException */
void removeFrameFiles(const std::string& folder, const std::string& extension,
                      const std::function<bool(int frame)>& is_removed = nullptr);

} // namespace pcl_semantic
