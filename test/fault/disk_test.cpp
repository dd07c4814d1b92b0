// SPDX-License-Identifier: BSD-3-Clause

// Makes each disk call fail once, or simulates a power loss.

#include "faults.h"

#include "io/sqlite_database.h"
#include "support/committed_archive.h"
#include "support/no_waits.h"
#include "support/run_sql.h"
#include "support/run_tool.h"
#include "support/tiny_street.h"

#include <pcl_semantic/core/exceptions.h>

#include <filesystem>
#include <random>

namespace pcl_semantic {

namespace {

namespace fs = std::filesystem;

constexpr int kCommits = 3;

void
expectSound(const std::string& path, int commits)
{
  EXPECT_TRUE(verifyArchive(path).empty());
  expectCommitted(MapArchive(path, ArchiveAccess::read), commits);
}

// Requires a valid or refused archive without its log; and another program may merge
// the log into the file.
void
expectSoundElsewhere(const std::string& path, int commits)
{
  const std::string alone = path + "-alone";
  fs::copy_file(path, alone);
  try {
    expectCommitted(MapArchive(alone, ArchiveAccess::read), commits);
  }
  catch (const BadInputException& error) {
    EXPECT_TRUE(holds(error.what(), "lacks " + alone + "-wal"));
  }
  EXPECT_EQ(runSql(path, "SELECT * FROM meta"), "");
  EXPECT_FALSE(fs::exists(path + "-wal"));
  EXPECT_NO_THROW(expectSound(path, commits));
}

// Possible files of an archive after a power loss during a list of calls: flushed data
// exists, and any part of the rest.
class Disk {
public:
  Disk(std::map<std::string, std::string> files, const std::vector<DiskCall>& calls,
       std::size_t count)
      : calls_(calls), flushed_(std::move(files))
  {
    for (std::size_t i = 0; i < count; ++i)
      if (calls[i].kind == DiskCall::Kind::sync)
        flush(calls[i].path);
      else
        pending_.push_back(i);
  }

  // \param[in] keeps whether the disk has kept a sector of a call that was not flushed
  std::map<std::string, std::string>
  after(const std::function<bool()>& keeps) const
  {
    auto files = flushed_;
    for (const std::size_t i : pending_)
      apply(calls_[i], files, keeps);
    return files;
  }

private:
  static constexpr std::size_t kSector = 512; // bytes that are kept or lost together

  using Files = std::map<std::string, std::string>;

  static void
  apply(const DiskCall& call, Files& files, const std::function<bool()>& keeps)
  {
    if (call.kind == DiskCall::Kind::remove) {
      if (keeps())
        files.erase(call.path);
      return;
    }
    std::string& file = files[call.path];
    const auto offset = std::size_t(call.offset);
    if (call.kind == DiskCall::Kind::truncate) {
      if (keeps())
        file.resize(offset);
      return;
    }
    for (std::size_t at = 0; at < call.bytes.size(); at += kSector) {
      const std::string sector = call.bytes.substr(at, kSector);
      if (!keeps())
        continue;
      if (file.size() < offset + at + sector.size())
        file.resize(offset + at + sector.size());
      file.replace(offset + at, sector.size(), sector);
    }
  }

  // The removal of a file is flushed with its folder.
  static bool
  isFlushedBy(const DiskCall& call, const std::string& path)
  {
    return call.kind == DiskCall::Kind::remove
               ? fs::path(call.path).parent_path() == path
               : call.path == path;
  }

  void
  flush(const std::string& path)
  {
    std::vector<std::size_t> left;
    for (const std::size_t i : pending_)
      if (isFlushedBy(calls_[i], path))
        apply(calls_[i], flushed_, [] { return true; });
      else
        left.push_back(i);
    pending_ = left;
  }

  const std::vector<DiskCall>& calls_;
  Files flushed_;
  std::vector<std::size_t> pending_; // calls, in order
};

} // namespace

TEST(Disk, NoFailedCallLosesWhatWasCommitted)
{
  const NoWaits no_waits;
  for (const CallFault fault :
       {CallFault::fails, CallFault::disk_full, CallFault::is_short})
    for (long before = 0;; ++before) {
      SCOPED_TRACE(before);
      const TemporaryFolder folder(TemporaryFolder::memory());
      const std::string path = folder.path("map");
      int commits = 0;
      bool has_failed = false;
      {
        const FailingCall call(fault, before);
        try {
          commitTimes(kCommits, *MapArchive::create(path, makeArchiveHeader()),
                      commits);
        }
        catch (const OutputException& error) {
          EXPECT_TRUE(holds(error.what(), path));
        }
        catch (const BadInputException& error) { // unreadable
          EXPECT_TRUE(holds(error.what(), path));
        }
        has_failed = call.hasFailed();
      }
      if (!has_failed)
        break;
      if (fs::exists(path))
        expectSound(path, commits);
      else
        EXPECT_EQ(commits, 0);
      ASSERT_FALSE(HasFailure());
    }
}

TEST(Disk, WithoutPowerNothingCommittedIsLost)
{
  const NoWaits no_waits;
  const TemporaryFolder folder(TemporaryFolder::memory()),
      later(TemporaryFolder::memory());
  const std::string path = folder.path("map");
  EXPECT_TRUE(MapArchive::create(path, makeArchiveHeader())->close());
  const std::map<std::string, std::string> begun = {{path, bytesOf(path)}};
  std::vector<DiskCall> calls;
  std::vector<std::size_t> ends; // calls before the end of each commit
  {
    const DiskRecorder recorder(folder.path());
    SqliteDatabase::max_log = 40; // forces a new log on the way
    MapArchive archive(path, ArchiveAccess::write);
    int commits = 0;
    commitTimes(kCommits, archive, commits,
                [&] { ends.push_back(recorder.calls().size()); });
    EXPECT_FALSE(fs::exists(path + "-wal"));
    calls = recorder.calls();
    SqliteDatabase::max_log = 1000;
  }
  EXPECT_GT(calls.size(), 40u);
  std::mt19937 random(1);
  for (std::size_t count = 0; count <= calls.size(); ++count) {
    const Disk disk(begun, calls, count);
    const int commits = int(std::count_if(
        ends.begin(), ends.end(), [&](std::size_t end) { return end <= count; }));
    for (int kept = 0; kept <= 4; ++kept) { // none, some, or all of the unflushed data
      SCOPED_TRACE(std::to_string(count) + " calls, " + std::to_string(kept));
      for (const auto& file : fs::directory_iterator(later.path()))
        fs::remove(file);
      for (const auto& [name, bytes] :
           disk.after([&] { return int(random() % 4) < kept; }))
        std::ofstream(later.path(fs::path(name).filename()), std::ios::binary) << bytes;
      EXPECT_NO_THROW(expectSound(later.path("map"), commits));
      if ((count + std::size_t(kept)) % 3 == 0)
        expectSoundElsewhere(later.path("map"), commits);
      ASSERT_FALSE(HasFailure());
    }
  }
}

// Makes one call of a run of the program fail. The program reports it or continues
// without harm, and the archive is valid.
TEST(Disk, NoFailedCallOfARunLosesWhatWasCommitted)
{
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer's own library has to be loaded first";
#endif
  if (!fs::exists(PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_map"))
    GTEST_SKIP() << "the programs were not built";
  const TemporaryFolder folder;
  const std::string faults =
      "LD_PRELOAD=" PCL_SEMANTIC_BINARY_DIR "/test/libpcl_semantic_faults.so ";
  const auto run = [&](const std::string& name, const std::string& environment) {
    return runTool(mapOf(tinyStreet()) + " --crf none --voxel-size 0.3 --output " +
                       folder.path(name) + " --archive-every 1 --archive " +
                       folder.path(name + ".map"),
                   "export OMP_NUM_THREADS=1 " + environment + faults + ";");
  };
  const std::string count = folder.path("count");
  ASSERT_EQ(run("whole", "PCL_SEMANTIC_FAULT_COUNT=" + count + " ").code, 0);
  const long calls = std::stol(bytesOf(count));
  ASSERT_GT(calls, 100);
  constexpr long kRuns = 36;
  int failed = 0;
  for (long i = 0; i < kRuns; ++i) {
    const char* const kind = i % 3 == 0 ? "fails" : i % 3 == 1 ? "disk" : "short";
    const std::string name = "run" + std::to_string(i);
    const ToolResult result =
        run(name, "PCL_SEMANTIC_FAULT=" + std::string(kind) + ":" +
                      std::to_string(calls * i / kRuns) + " ");
    SCOPED_TRACE(result.text);
    EXPECT_TRUE(result.code == 0 || result.code == 3 || result.code == 5)
        << result.code;
    failed += result.code != 0;
    if (result.code != 0) {
      EXPECT_EQ(result.text.rfind("pcl_semantic_map: ", 0), 0u);
    }
    const std::string archive = folder.path(name + ".map");
    if (fs::exists(archive)) {
      EXPECT_TRUE(verifyArchive(archive).empty());
    }
    fs::remove_all(folder.path(name));
  }
  EXPECT_GT(failed, kRuns / 4);
}

} // namespace pcl_semantic
