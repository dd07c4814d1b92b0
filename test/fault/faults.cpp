// SPDX-License-Identifier: BSD-3-Clause
//
// The functions of the C library that this file defines take the place of its own in
// the program that it is linked to, and in all libraries of that program; preloaded as
// a library, in any program: PCL_SEMANTIC_FAULT=KIND:BEFORE then says which call goes
// wrong, and PCL_SEMANTIC_FAULT_COUNT a file for the number of calls there were.
#include "faults.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

namespace pcl_semantic {

namespace {

constexpr long never = -1;

// Other models of thread-local storage may call malloc in a preloaded library.
#define PCL_SEMANTIC_THREAD_LOCAL                                                      \
  __attribute__((tls_model("initial-exec"))) thread_local
PCL_SEMANTIC_THREAD_LOCAL long allocations_left = never;
PCL_SEMANTIC_THREAD_LOCAL bool allocation_failed = false;

bool
isAllocationToFail()
{
  if (allocations_left == never || allocation_failed)
    return false;
  allocation_failed = allocations_left-- == 0;
  return allocation_failed;
}

std::atomic<long> calls_left{never};
std::atomic<long> calls{0};
std::atomic<bool> call_failed{false};
CallFault call_fault = CallFault::fails;

// Standard streams do not count as files.
bool
isCallToFail(int descriptor = INT_MAX)
{
  if (descriptor <= STDERR_FILENO)
    return false;
  ++calls;
  if (calls_left == never || call_failed || calls_left-- != 0)
    return false;
  call_failed = true;
  return true;
}

long
failed()
{
  errno = call_fault == CallFault::disk_full ? ENOSPC : EIO;
  return -1;
}

std::vector<DiskCall>* recorded = nullptr;
std::string recorded_path;

void
record(int descriptor, DiskCall::Kind kind, std::int64_t offset, const void* bytes,
       std::size_t size)
{
  if (!recorded)
    return;
  char path[4096];
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  const ssize_t length = ::readlink(link.c_str(), path, sizeof path);
  const std::string name(path, std::size_t(std::max<ssize_t>(length, 0)));
  if (name.rfind(recorded_path, 0) == 0)
    recorded->push_back(
        {name, kind, offset, std::string(static_cast<const char*>(bytes), size)});
}

// A transfer of bytes that may fail: `call` transfers the given number.
template <typename Call>
ssize_t
transfer(int descriptor, std::size_t size, Call&& call)
{
  if (!isCallToFail(descriptor))
    return call(size);
  if (call_fault == CallFault::is_short && size > 1)
    return call(size / 2);
  return failed();
}

// For programs with this preloaded library.
struct Environment {
  Environment()
  {
    const char* const fault = std::getenv("PCL_SEMANTIC_FAULT");
    const char* const before = fault ? std::strchr(fault, ':') : nullptr;
    if (!before)
      return;
    call_fault = fault[0] == 's'   ? CallFault::is_short
                 : fault[0] == 'd' ? CallFault::disk_full
                                   : CallFault::fails;
    calls_left = std::atol(before + 1);
  }

  ~Environment()
  {
    if (const char* const path = std::getenv("PCL_SEMANTIC_FAULT_COUNT"))
      if (std::FILE* const file = std::fopen(path, "w")) {
        std::fprintf(file, "%ld\n", calls.load());
        std::fclose(file);
      }
  }
};

const Environment environment;

} // namespace

FailingAllocation::FailingAllocation(long before)
{
  allocation_failed = false;
  allocations_left = before;
}

FailingAllocation::~FailingAllocation()
{
  allocations_left = never;
}

bool
FailingAllocation::hasFailed() const
{
  return allocation_failed;
}

FailingCall::FailingCall(CallFault fault, long before)
{
  call_fault = fault;
  call_failed = false;
  calls_left = before;
}

FailingCall::~FailingCall()
{
  calls_left = never;
}

bool
FailingCall::hasFailed() const
{
  return call_failed;
}

DiskRecorder::DiskRecorder(const std::string& begin_of_path)
{
  recorded_path = begin_of_path;
  recorded = new std::vector<DiskCall>();
}

DiskRecorder::~DiskRecorder()
{
  delete recorded;
  recorded = nullptr;
}

const std::vector<DiskCall>&
DiskRecorder::calls() const
{
  return *recorded;
}

} // namespace pcl_semantic

using namespace pcl_semantic;

extern "C" {

ssize_t
write(int descriptor, const void* bytes, size_t size)
{
  return transfer(descriptor, size, [&](std::size_t count) {
    const off_t at = recorded ? ::lseek(descriptor, 0, SEEK_CUR) : 0;
    const ssize_t written = ::syscall(SYS_write, descriptor, bytes, count);
    if (written > 0)
      record(descriptor, DiskCall::Kind::write, at, bytes, std::size_t(written));
    return written;
  });
}

ssize_t
writev(int descriptor, const struct iovec* parts, int count)
{
  if (isCallToFail(descriptor))
    return failed();
  return ::syscall(SYS_writev, descriptor, parts, count);
}

ssize_t
pwrite64(int descriptor, const void* bytes, size_t size, off64_t offset)
{
  return transfer(descriptor, size, [&](std::size_t count) {
    const ssize_t written = ::syscall(SYS_pwrite64, descriptor, bytes, count, offset);
    if (written > 0)
      record(descriptor, DiskCall::Kind::write, offset, bytes, std::size_t(written));
    return written;
  });
}

ssize_t
pwrite(int descriptor, const void* bytes, size_t size, off_t offset)
{
  return pwrite64(descriptor, bytes, size, offset);
}

ssize_t
read(int descriptor, void* bytes, size_t size)
{
  return transfer(descriptor, size, [&](std::size_t count) {
    return ::syscall(SYS_read, descriptor, bytes, count);
  });
}

ssize_t
pread64(int descriptor, void* bytes, size_t size, off64_t offset)
{
  return transfer(descriptor, size, [&](std::size_t count) {
    return ::syscall(SYS_pread64, descriptor, bytes, count, offset);
  });
}

ssize_t
pread(int descriptor, void* bytes, size_t size, off_t offset)
{
  return pread64(descriptor, bytes, size, offset);
}

int
ftruncate64(int descriptor, off64_t size) noexcept
{
  if (isCallToFail(descriptor))
    return int(failed());
  const int result = int(::syscall(SYS_ftruncate, descriptor, size));
  if (result == 0)
    record(descriptor, DiskCall::Kind::truncate, size, "", 0);
  return result;
}

int
ftruncate(int descriptor, off_t size) noexcept
{
  return ftruncate64(descriptor, size);
}

int
fsync(int descriptor)
{
  if (isCallToFail(descriptor))
    return int(failed());
  record(descriptor, DiskCall::Kind::sync, 0, "", 0);
  return int(::syscall(SYS_fsync, descriptor));
}

int
fdatasync(int descriptor)
{
  if (isCallToFail(descriptor))
    return int(failed());
  record(descriptor, DiskCall::Kind::sync, 0, "", 0);
  return int(::syscall(SYS_fdatasync, descriptor));
}

int
unlink(const char* path) noexcept
{
  if (isCallToFail())
    return int(failed());
  if (recorded && std::string(path).rfind(recorded_path, 0) == 0)
    recorded->push_back({path, DiskCall::Kind::remove, 0, ""});
  return int(::syscall(SYS_unlink, path));
}

int
rename(const char* from, const char* to) noexcept
{
  return isCallToFail() ? int(failed())
                        : int(::syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}

int
renameat2(int from_folder, const char* from, int to_folder, const char* to,
          unsigned flags) noexcept
{
  return isCallToFail()
             ? int(failed())
             : int(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}

} // extern "C"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PCL_SEMANTIC_FOREIGN_MALLOC
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PCL_SEMANTIC_FOREIGN_MALLOC
#endif
#endif

#ifdef PCL_SEMANTIC_FOREIGN_MALLOC

void*
operator new(std::size_t size)
{
  void* const memory = isAllocationToFail() ? nullptr : std::malloc(size);
  if (!memory)
    throw std::bad_alloc();
  return memory;
}

void
operator delete(void* memory) noexcept
{
  std::free(memory);
}

void
operator delete(void* memory, std::size_t) noexcept
{
  std::free(memory);
}

#else

extern "C" {

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

static void*
noMemory()
{
  errno = ENOMEM;
  return nullptr;
}

void*
malloc(size_t size)
{
  return isAllocationToFail() ? noMemory() : __libc_malloc(size);
}

void*
calloc(size_t count, size_t size)
{
  return isAllocationToFail() ? noMemory() : __libc_calloc(count, size);
}

void*
realloc(void* memory, size_t size)
{
  return isAllocationToFail() ? noMemory() : __libc_realloc(memory, size);
}

void*
aligned_alloc(size_t alignment, size_t size)
{
  return isAllocationToFail() ? noMemory() : __libc_memalign(alignment, size);
}

int
posix_memalign(void** memory, size_t alignment, size_t size)
{
  if (isAllocationToFail())
    return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory ? 0 : ENOMEM;
}

} // extern "C"

#endif
