// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <shared_mutex>

namespace pcl_semantic {

/** \brief One writer or any number of readers. New readers queue behind a waiting
 * writer, so frequent readers cannot starve it. */
class ReadWriteLock {
public:
  std::shared_lock<std::shared_mutex>
  read()
  {
    const std::lock_guard<std::mutex> turn(turn_);
    return std::shared_lock<std::shared_mutex>(mutex_);
  }

  std::unique_lock<std::shared_mutex>
  write()
  {
    const std::lock_guard<std::mutex> turn(turn_);
    return std::unique_lock<std::shared_mutex>(mutex_);
  }

private:
  std::mutex turn_;
  std::shared_mutex mutex_;
};

} // namespace pcl_semantic
