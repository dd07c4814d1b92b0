// SPDX-License-Identifier: BSD-3-Clause
#include "folder_lock.h"

#include <pcl_semantic/core/exceptions.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

namespace pcl_semantic {

FolderLock::FolderLock(const std::string& folder)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC))
{
  // Not every network file system can lock: then nothing keeps others out.
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) == 0 ||
      errno != EWOULDBLOCK)
    return;
  close(descriptor_);
  PCL_THROW_EXCEPTION(OutputException, folder << ": another run is writing to it");
}

FolderLock::~FolderLock()
{
  if (descriptor_ >= 0)
    close(descriptor_);
}

} // namespace pcl_semantic
