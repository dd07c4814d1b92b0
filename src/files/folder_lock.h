// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"

#include <cerrno>
#include <fcntl.h>
#include <string>
#include <sys/file.h>
#include <unistd.h>

namespace pcl_semantic {

/** \brief Keeps a second process, or object, from writing to a folder at the same time;
 * it ends with its owner, however that ends. */
class FolderLock {
public:
  /** \throws OutputException if another one holds it */
  explicit FolderLock(const std::string& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
  {
    // Not every network file system can lock: then nothing keeps others out.
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 ||
        errno != EWOULDBLOCK)
      return;
    ::close(descriptor_);
    fail<OutputException>(folder, ": another run is writing to it");
  }

  ~FolderLock()
  {
    if (descriptor_ >= 0)
      ::close(descriptor_);
  }

  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

private:
  int descriptor_;
};

} // namespace pcl_semantic
