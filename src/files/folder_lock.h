// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fail.h"

#include <cerrno>
#include <fcntl.h>
#include <string>
#include <sys/file.h>
#include <unistd.h>

namespace pcl_semantic {

/** \brief Locks a folder against other processes or objects that write to it. The lock
 * ends with its process, even after a crash. */
class FolderLock {
public:
  /** \throws OutputException if the folder is locked */
  explicit FolderLock(const std::string& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
  {
    // Some network file systems have no locks; then the folder is unprotected.
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
