// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief As long as it lives, one allocation of this thread fails: malloc and its kin
 * give null, operator new throws. Under sanitizers, whose malloc stays theirs, operator
 * new alone. */
class FailingAllocation {
public:
  /** \param[in] before allocations that succeed before it */
  explicit FailingAllocation(long before);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;

  /** \brief Whether it has failed already. */
  bool hasFailed() const;
};

/** \brief How a system call goes wrong. */
enum class CallFault {
  fails,     ///< does nothing and gives EIO
  disk_full, ///< does nothing and gives ENOSPC
  is_short   ///< reads or writes half of what it should; others fail
};

/** \brief As long as it lives, one call of this process that changes or reads a file
 * (write, pwrite, read, pread, ftruncate, fsync, fdatasync, rename, unlink) goes wrong.
 */
class FailingCall {
public:
  FailingCall(CallFault fault, long before);
  ~FailingCall();
  FailingCall(const FailingCall&) = delete;
  FailingCall& operator=(const FailingCall&) = delete;

  bool hasFailed() const;
};

/** \brief What a process asks of the disk, in order. */
struct DiskCall {
  enum class Kind { write, truncate, sync, remove };

  std::string path;
  Kind kind = Kind::sync;
  std::int64_t offset = 0; ///< of a write; new size of a truncated file
  std::string bytes;
};

/** \brief As long as it lives, records what this process does to files whose path
 * begins with something. */
class DiskRecorder {
public:
  explicit DiskRecorder(const std::string& begin_of_path);
  ~DiskRecorder();
  DiskRecorder(const DiskRecorder&) = delete;
  DiskRecorder& operator=(const DiskRecorder&) = delete;

  const std::vector<DiskCall>& calls() const;
};

} // namespace pcl_semantic
