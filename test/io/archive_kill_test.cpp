// SPDX-License-Identifier: BSD-3-Clause

// A writer that ends before any one of its system calls.

#include "io/sqlite_database.h"
#include "support/committed_archive.h"
#include "support/no_waits.h"
#include "support/run_sql.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>

#include <omp.h>

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

// What SQLite asks of the system that changes something on the disk.
const char* const calls[] = {"write",  "pwrite",    "pwrite64", "ftruncate",
                             "unlink", "fallocate", "open"};
int calls_left = 0;

// Replaces a system call: the process ends in it, or performs the original call.
template <std::size_t call> sqlite3_syscall_ptr meant = nullptr;

template <std::size_t call, typename... Arguments>
long
endOrGoOn(Arguments... arguments)
{
  if (calls_left-- == 0)
    ::_exit(1);
  return reinterpret_cast<long (*)(Arguments...)>(meant<call>)(arguments...);
}

template <std::size_t call, typename... Arguments>
void
replaceCall(sqlite3_vfs& vfs)
{
  meant<call> = vfs.xGetSystemCall(&vfs, calls[call]);
  if (meant<call>)
    vfs.xSetSystemCall(
        &vfs, calls[call],
        reinterpret_cast<sqlite3_syscall_ptr>(&endOrGoOn<call, Arguments...>));
}

// Runs a writer in a process of its own that ends before call number `calls_before`.
// Returns whether it has come to its end.
bool
runUntil(int calls_before, const std::function<void()>& write)
{
  const pid_t child = ::fork();
  if (child == 0) {
    sqlite3_vfs& vfs = *sqlite3_vfs_find(nullptr);
    calls_left = calls_before;
    replaceCall<0, long, const void*, long>(vfs);
    replaceCall<1, long, const void*, long, long>(vfs);
    replaceCall<2, long, const void*, long, long>(vfs);
    replaceCall<3, long, long>(vfs);
    replaceCall<4, const char*>(vfs);
    replaceCall<5, long, long, long>(vfs);
    replaceCall<6, const char*, long, long>(vfs);
    try {
      write();
    }
    catch (...) {
      ::_exit(2);
    }
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) < 2) << status;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

constexpr int kCommits = 2;

// \param[in] max_log pages after which the log is merged into the file and restarted
void
killAndRead(int max_log)
{
  const NoWaits no_waits;
  SqliteDatabase::max_log = max_log;
  omp_set_num_threads(1); // a forked process has no other
  auto& commits = *static_cast<int*>(::mmap(
      nullptr, sizeof(int), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
  int refused = 0;
  bool ended = false;
  for (int calls_before = 0; !ended; ++calls_before) {
    SCOPED_TRACE(calls_before);
    const TemporaryFolder folder(TemporaryFolder::memory());
    const std::string path = folder.path("map"), copy = folder.path("copy");
    commits = 0;
    ended = runUntil(calls_before, [&] {
      commitTimes(kCommits, *MapArchive::create(path, makeArchiveHeader()), commits);
    });
    if (!fs::exists(path)) {
      EXPECT_EQ(commits, 0);
      continue;
    }
    // FILE alone has everything, or is refused.
    fs::copy_file(path, copy);
    try {
      expectCommitted(MapArchive(copy, ArchiveAccess::read), commits);
    }
    catch (const BadInputException& error) {
      EXPECT_TRUE(holds(error.what(), "lacks " + copy + "-wal"));
      ++refused;
    }
    expectCommitted(MapArchive(path, ArchiveAccess::read), commits);
    // Another program brings the log into the file, or is killed on the way.
    const std::string other = folder.path("other");
    for (int calls_of_other = calls_before % 7;; calls_of_other += 7) {
      for (const auto& [ending, is_there] : {std::pair("", true),
                                             {"-wal", fs::exists(path + "-wal")},
                                             {"-shm", false}}) {
        fs::remove(other + ending);
        if (is_there)
          fs::copy_file(path + ending, other + ending);
      }
      const bool has_ended = runUntil(calls_of_other, [&] {
        EXPECT_EQ(runSql(other, "PRAGMA journal_mode = WAL; SELECT * FROM meta"), "");
      });
      EXPECT_FALSE(has_ended && fs::exists(other + "-wal"));
      expectCommitted(MapArchive(other, ArchiveAccess::read), commits);
      ASSERT_FALSE(testing::Test::HasFailure())
          << calls_of_other << " calls of another";
      if (has_ended)
        break;
    }
    {
      MapArchive archive(path, ArchiveAccess::write);
      expectCommitted(archive, commits);
      EXPECT_TRUE(archive.close());
    }
    EXPECT_FALSE(fs::exists(path + "-wal"));
    ASSERT_FALSE(testing::Test::HasFailure());
  }
  EXPECT_EQ(commits, kCommits);
  EXPECT_GT(refused, 10);
  SqliteDatabase::max_log = 1000;
}

} // namespace

TEST(ArchiveKill, BeforeAnySystemCallNothingCommittedIsLost)
{
  for (const int max_log : {1000, 5}) // the second restarts the log
    killAndRead(max_log);
}

} // namespace pcl_semantic
