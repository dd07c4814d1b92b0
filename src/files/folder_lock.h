// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace pcl_semantic {

/** \brief Keeps a second process, or object, from writing to a folder at the same time;
 * it ends with its owner, however that ends. */
class FolderLock {
public:
  /** \throws OutputException if another one holds it */
  explicit FolderLock(const std::string& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

private:
  int descriptor_;
};

} // namespace pcl_semantic
