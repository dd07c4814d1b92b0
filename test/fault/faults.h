// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace pcl_semantic {

/** \brief Makes one allocation of this thread fail during its lifetime: malloc and
 * similar functions return null, operator new throws. With sanitizers, which keep their
 * own malloc, only operator new fails. */
class FailingAllocation {
public:
  /** \param[in] before number of allocations that succeed first */
  explicit FailingAllocation(long before);
  ~FailingAllocation();
  FailingAllocation(const FailingAllocation&) = delete;
  FailingAllocation& operator=(const FailingAllocation&) = delete;

  /** \brief Whether the allocation has failed already. */
  bool hasFailed() const;
};

/** \brief Failure of a system call. */
enum class CallFault {
  fails,     ///< does nothing and returns EIO
  disk_full, ///< does nothing and returns ENOSPC
  is_short   ///< reads or writes half of its bytes; others fail
};

/** \brief Makes one call of this process that changes or reads a file (write, pwrite,
 * read, pread, ftruncate, fsync, fdatasync, rename, unlink) fail during its
 * lifetime. */
class FailingCall {
public:
  FailingCall(CallFault fault, long before);
  ~FailingCall();
  FailingCall(const FailingCall&) = delete;
  FailingCall& operator=(const FailingCall&) = delete;

  bool hasFailed() const;
};

/** \brief Disk operation of a process. */
struct DiskCall {
  enum class Kind { write, truncate, sync, remove };

  std::string path;
  Kind kind = Kind::sync;
  std::int64_t offset = 0; ///< of a write; new size of a truncated file
  std::string bytes;
};

/** \brief Records the operations of this process on files whose path has a prefix,
 * during its lifetime. */
class DiskRecorder {
public:
  explicit DiskRecorder(const std::string& begin_of_path);
  ~DiskRecorder();
  DiskRecorder(const DiskRecorder&) = delete;
  DiskRecorder& operator=(const DiskRecorder&) = delete;

  const std::vector<DiskCall>& calls() const;
};

} // namespace pcl_semantic
