// SPDX-License-Identifier: BSD-3-Clause
#include "support/process_limits.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/core/exceptions.h>
#include <pcl_semantic/files/atomic_file.h>
#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/images/distribution_file.h>
#include <pcl_semantic/images/image_file.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <chrono>
#include <csignal>
#include <functional>
#include <locale>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace pcl_semantic;

TEST(AtomicFile, TheContentChangesWithCommitOnly)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("a.txt");
  {
    AtomicFile file(path);
    file.stream() << "hello" << std::flush;
    EXPECT_FALSE(std::filesystem::exists(path));
    file.commit();
    EXPECT_EQ(bytesOf(path), "hello");
  }
  EXPECT_EQ(bytesOf(path), "hello");
  EXPECT_EQ(folder.entries(), 1u);
  {
    AtomicFile file(path);
    file.stream() << "new" << std::flush;
  }
  EXPECT_EQ(bytesOf(path), "hello");
  EXPECT_EQ(folder.entries(), 1u);
  writeTextFile(path, "newer");
  EXPECT_EQ(bytesOf(path), "newer");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, AFullDiskLeavesTheOldContent)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("a.txt", "old");
  {
    const FullDisk full(65536);
    const std::string message = thrownMessage<OutputException>(
        [&] { writeTextFile(path, std::string(1000000, 'x')); });
    EXPECT_TRUE(holds(message, path));
    // The last bytes fail only when the stream is closed.
    thrownMessage<OutputException>(
        [&] { writeTextFile(path, std::string(65537, 'x')); });
  }
  EXPECT_EQ(bytesOf(path), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(AtomicFile, EveryWriterLeavesNothingOnAFullDisk)
{
  cv::Mat picture(100, 100, CV_8UC3);
  cv::randu(picture, 0, 256);
  LabelledCloud labelled;
  labelled.cloud->resize(10000);
  PcdTable table;
  table.width = 10000;
  table.height = 1;
  table.setColumn("x", std::vector<float>(10000));
  using Write = std::function<void(const std::string& path)>;
  for (const Write& write : std::vector<Write>{
           [&](auto& path) { writePng(path, picture); },
           [&](auto& path) { writeDistributions(path, LabelDistributions(11, 10000)); },
           [&](auto& path) { writeLabelledCloud(path, labelled); },
           [&](auto& path) { writeCloudTable(path, table); }}) {
    const TemporaryFolder folder;
    const FullDisk full(10000);
    thrownMessage<OutputException>([&] { write(folder.path("a.file")); });
    EXPECT_EQ(folder.entries(), 0u);
  }
}

TEST(AtomicFile, RefusesWhatCannotBeWritten)
{
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "x"), pipe = folder.path("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path :
       {folder.path(), folder.path("no_such_folder/a.txt"), file + "/a.txt",
        folder.path(std::string(300, 'x')), pipe})
    expectRefusal<OutputException>(path, [&] { writeTextFile(path, "x"); });
  for (const std::string& path : {file, file + "/a"})
    expectRefusal<OutputException>(path, [&] { makeOutputFolder(path); });
  EXPECT_EQ(bytesOf(file), "x");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  EXPECT_EQ(folder.entries(), 2u);
}

TEST(AtomicFile, WritesNumbersInTheClassicLocale)
{
  struct Comma : std::numpunct<char> {
    char
    do_decimal_point() const override
    {
      return ',';
    }
    std::string
    do_grouping() const override
    {
      return "\3";
    }
  };
  const TemporaryFolder folder;
  const std::locale before =
      std::locale::global(std::locale(std::locale::classic(), new Comma));
  {
    AtomicFile file(folder.path("a.txt"));
    file.stream() << 12345 << ' ' << 1.5;
    file.commit();
  }
  std::locale::global(before);
  EXPECT_EQ(bytesOf(folder.path("a.txt")), "12345 1.5");
}

TEST(MakeOutputFolder, MakesTheParentsAndLeavesNothing)
{
  const TemporaryFolder folder;
  for (const char* const name : {"a/b/c", "a/b/c", "d/"}) {
    makeOutputFolder(folder.path(name));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path(name))) << name;
  }
}

// Removes the files of killed processes, but no file that a process may still write.
TEST(MakeOutputFolder, RemovesTheTemporariesOfEndedProcesses)
{
  namespace fs = std::filesystem;
  const TemporaryFolder folder;
  const pid_t killed = ::fork();
  if (killed == 0) {
    AtomicFile file(folder.path("a.txt"));
    file.stream() << "half" << std::flush;
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(killed, nullptr, 0);
  ASSERT_EQ(folder.entries(), 1u);
  const fs::path left = fs::directory_iterator(folder.path())->path();
  AtomicFile file(folder.path("b.txt"));
  file.stream() << "whole" << std::flush;
  makeOutputFolder(folder.path());
  EXPECT_TRUE(fs::exists(left)) << "as young as one that is not locked yet";
  const auto before = fs::file_time_type::clock::now() - std::chrono::seconds(11);
  folder.write(".hidden", "of somebody else");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
    fs::last_write_time(entry, before);
  makeOutputFolder(folder.path());
  EXPECT_FALSE(fs::exists(left));
  EXPECT_EQ(folder.entries(), 2u);
  file.commit();
  EXPECT_EQ(bytesOf(folder.path("b.txt")), "whole");
  EXPECT_TRUE(fs::exists(folder.path(".hidden")));
}

TEST(RemoveFrameFiles, RemovesFramesAndNothingElse)
{
  const TemporaryFolder folder;
  const std::string path = folder.path("labels");
  makeOutputFolder(path);
  const std::pair<const char*, bool> files[] = {{"/000001.png", false},
                                                {"/000002.png", false},
                                                {"/000001.bin", true},
                                                {"/notes.png", true}};
  for (const auto& [name, stays] : files)
    writeTextFile(path + name, "x");
  removeFrameFiles(path, ".png");
  for (const auto& [name, stays] : files)
    EXPECT_EQ(std::filesystem::exists(path + name), stays) << name;
}
