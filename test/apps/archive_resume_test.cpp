// SPDX-License-Identifier: BSD-3-Clause

// pcl_semantic_map --archive: a killed run can be resumed, with the same result.

#include "support/mapped_street.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <pcl_semantic/io/map_archive.h>

#include <random>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

constexpr int frames = 11;

std::string
mapCommand(const std::string& output, const std::string& archive,
           const std::string& more = "", const std::string& street = thereAndBack())
{
  return mapOf(street) +
         " --voxel-size 0.2 --window 16,6,6 --max-depth 8 --crf-every 3 "
         "--output " +
         output + " " +
         (archive.empty() ? "" : "--archive-every 2 --archive " + archive + " ") + more;
}

// The same, for a shell.
std::string
shellCommand(const std::string& arguments)
{
  return PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_" + arguments;
}

// All files but the summary, which contains seconds, and temporary files of a killed
// run.
std::map<std::string, std::string>
contentOf(const std::string& output)
{
  std::map<std::string, std::string> content;
  for (const std::string& file : filesIn(output))
    if (file != "summary.json" && fs::path(file).filename().string()[0] != '.')
      content[file] = bytesOf(output + "/" + file);
  return content;
}

std::string
exportOf(const std::string& archive)
{
  const std::string path = archive + ".pcd";
  succeed("archive export " + archive + " " + path);
  return bytesOf(path);
}

class ArchivedRun : public testing::Test {
protected:
  void
  SetUp() override
  {
    const ToolResult result = runTool(mapCommand(whole_, whole_archive_));
    ASSERT_EQ(result.code, 0) << result.text;
  }

  // Resumes the run and expects the result of the uninterrupted run.
  ToolResult
  expectGoesOn(const std::string& output, const std::string& archive) const
  {
    const ToolResult result = runTool(mapCommand(output, archive, "--resume"));
    EXPECT_EQ(result.code, 0) << result.text;
    EXPECT_TRUE(exportOf(archive) == exportOf(whole_archive_));
    const auto content = contentOf(output), expected = contentOf(whole_);
    EXPECT_EQ(content.size(), expected.size());
    for (const auto& [file, bytes] : expected)
      EXPECT_TRUE(content.count(file) > 0 && content.at(file) == bytes) << file;
    const nlohmann::json summary = readJson(output + "/summary.json");
    EXPECT_EQ(summary["finished"], true);
    EXPECT_EQ(summary["frames"], frames);
    EXPECT_EQ(summary["points"], readJson(whole_ + "/summary.json")["points"]);
    EXPECT_TRUE(verifyArchive(archive).empty());
    EXPECT_FALSE(fs::exists(archive + "-wal"));
    return result;
  }

  // Kills a run some milliseconds after a file of its output is there; an empty name:
  // after its start. \return whether it had not ended before
  static bool
  kill(const std::string& output, const std::string& archive, const std::string& file,
       int milliseconds, const std::string& more = "--resume")
  {
    const std::string wait = "while kill -0 $! && ! test -e " + output + "/" + file +
                             "; do sleep 0.01; done; ";
    const ToolResult result =
        runShell("exec 2>&1; " + shellCommand(mapCommand(output, archive, more)) +
                 " & " + (file.empty() ? "" : wait) + "sleep " +
                 std::to_string(0.001 * milliseconds) + "; kill -KILL $!; wait $!");
    return result.code == 137;
  }

  const TemporaryFolder folder_;
  const std::string whole_ = folder_.path("whole");
  const std::string whole_archive_ = folder_.path("whole.map");
};

} // namespace

TEST_F(ArchivedRun, IsTheMapOfARunWithoutArchive)
{
  succeed(mapCommand(folder_.path("plain"), ""));
  EXPECT_TRUE(contentOf(folder_.path("plain")) == contentOf(whole_));
  EXPECT_TRUE(exportOf(whole_archive_) == bytesOf(whole_ + "/map.pcd"));
  // The window has lost blocks on the way, or nothing of this would be tested.
  const MapArchive archive(whole_archive_, ArchiveAccess::read);
  EXPECT_TRUE(archive.state().finished);
  VoxelIndex low = VoxelIndex::Constant(kMaxVoxelIndex), high = -low;
  archive.forEach([&](const VoxelIndex& index, const VoxelBlock&) {
    low = low.cwiseMin(index);
    high = high.cwiseMax(index);
  });
  EXPECT_GT((high - low).y() * kBlockEdge * 0.2, 10.0);
}

TEST_F(ArchivedRun, KilledAtAnyMomentItGoesOn)
{
  std::vector<std::string> files = {"", ""};
  for (int frame = 0; frame < frames; ++frame)
    files.push_back("labels/" + frameFileName(frame, ".png"));
  files.insert(files.end(), {"final_labels/000000.png", "map_classes.pcd"});
  std::mt19937 random(1);
  int resumed = 0, killed = 0;
  for (std::size_t i = 0; i < files.size(); ++i) {
    SCOPED_TRACE(files[i]);
    const std::string output = folder_.path("out"), archive = folder_.path("run.map");
    fs::remove_all(output);
    fs::remove(archive);
    killed += kill(output, archive, files[i], int(random() % 50));
    if (i % 5 == 0) // once more, some frames later
      killed += kill(output, archive, files[std::min(i + 5, files.size() - 1)],
                     int(random() % 50));
    const ToolResult result = expectGoesOn(output, archive);
    resumed += result.text.rfind("resumed_after: ", 0) == 0;
  }
  EXPECT_GE(killed, 8) << "runs end before they can be killed";
  EXPECT_GE(resumed, 8) << "runs are killed before their first commit";
}

TEST_F(ArchivedRun, InterruptedItCommitsAndGoesOn)
{
  // The CRF has not refined the frame after these. The refinement at the end of a run
  // must not be part of the state from which a longer run is resumed.
  for (const auto& [signal, frame] :
       {std::pair<std::string, int>{"INT", 1}, {"HUP", 3}, {"INT", 4}}) {
    SCOPED_TRACE(frame);
    const std::string name = std::to_string(frame);
    const std::string output = folder_.path("out" + name);
    const std::string archive = folder_.path(name + ".map");
    const ToolResult result =
        runShell(shellCommand(mapCommand(output, archive)) +
                 " 2>&1 & while kill -0 $! && ! test -e " + output + "/labels/00000" +
                 name + ".png; do sleep 0.01; done; kill -" + signal + " $!; wait $!");
    EXPECT_EQ(result.code, 130) << result.text;
    {
      const MapArchive interrupted(archive, ArchiveAccess::read);
      EXPECT_FALSE(interrupted.state().finished);
      const nlohmann::json summary = readJson(output + "/summary.json");
      EXPECT_EQ(summary["finished"], false);
      const int written = summary["frames"];
      EXPECT_EQ(interrupted.state().frames, std::uint64_t(written))
          << "an interrupt commits the frames since the last commit";
      EXPECT_GT(written, frame);
      EXPECT_LT(written, frames);
      std::vector<std::string> names;
      for (int i = 0; i < written; ++i)
        names.push_back(frameFileName(i, ""));
      EXPECT_EQ(filesIn(output), filesOfMap(names));
    }
    EXPECT_TRUE(holds(succeed("export " + output + " " + folder_.path(name + ".ply")),
                      "the run was interrupted; the map holds the frames up to then"));
    EXPECT_FALSE(fs::exists(archive + "-wal"));
    EXPECT_NE(runTool("archive info " + archive).text.find("interrupted"),
              std::string::npos);
    expectGoesOn(output, archive);
  }
}

TEST_F(ArchivedRun, AFinishedRunStaysAsItIs)
{
  const std::string before = bytesOf(whole_ + "/map.pcd");
  fs::remove(whole_ + "/map.pcd");
  const ToolResult result = expectGoesOn(whole_, whole_archive_);
  EXPECT_EQ(result.text.rfind("resumed_after: 11\n", 0), 0u) << result.text;
  EXPECT_TRUE(bytesOf(whole_ + "/map.pcd") == before);
}

TEST_F(ArchivedRun, ADifferentNumberOfThreadsMayGoOn)
{
  const std::string output = folder_.path("out"), archive = folder_.path("run.map");
  EXPECT_TRUE(kill(output, archive, "labels/000003.png", 0, "--threads 1"));
  succeed(mapCommand(output, archive, "--resume --threads 3"));
  EXPECT_TRUE(exportOf(archive) == exportOf(whole_archive_));
}

TEST_F(ArchivedRun, WhatTheCrfWroteBackIsInTheArchive)
{
  const std::string more = "--config " +
                           folder_.write("back.yaml", "crf_write_back: true\n") +
                           " --network-every 3";
  const std::string whole = folder_.path("back.map");
  succeed(mapCommand(folder_.path("back"), whole, more));
  EXPECT_FALSE(exportOf(whole) == exportOf(whole_archive_));
  const std::string output = folder_.path("out"), archive = folder_.path("run.map");
  EXPECT_TRUE(kill(output, archive, "labels/000003.png", 0, more));
  // On another processor, too: all tiers give the same bits.
  succeed(mapCommand(output, archive, "--resume " + more), "PCL_SEMANTIC_SIMD=plain");
  EXPECT_TRUE(exportOf(archive) == exportOf(whole));
}

TEST_F(ArchivedRun, WithoutImagesNoneAreLeft)
{
  const std::string output = folder_.path("out"), archive = folder_.path("run.map");
  EXPECT_TRUE(kill(output, archive, "labels/000003.png", 0));
  succeed(mapCommand(output, archive, "--resume --map-only"));
  EXPECT_FALSE(
      holds(succeed(mapCommand(folder_.path("plain"), "", "--map-only")), "overlay"));
  EXPECT_EQ(filesIn(folder_.path("plain")), filesOfMap({}));
  for (const char* const file : {"/map.pcd", "/trajectory.txt", "/top_view.png"})
    EXPECT_TRUE(bytesOf(folder_.path("plain") + file) == bytesOf(whole_ + file));
  EXPECT_TRUE(contentOf(output) == contentOf(folder_.path("plain")));
  // Also where nothing is left to map.
  succeed(mapCommand(whole_, whole_archive_, "--resume --map-only"));
  EXPECT_EQ(filesIn(whole_), filesOfMap({}));
  EXPECT_FALSE(fs::exists(whole_ + "/labels"));
  expectFails(mapCommand(output, archive, "--resume"), 3,
              "with --map-only if that run had it");
}

TEST_F(ArchivedRun, AnotherRunDoesNotGoOn)
{
  const TemporaryFolder copies;
  const std::string street = copies.path("street");
  fs::copy(thereAndBack(), street, fs::copy_options::recursive);
  const std::string output = copies.path("out"), archive = copies.path("run.map");
  succeed(mapCommand(output, archive, "", street));
  const std::string bytes = bytesOf(archive);
  const auto refuses = [&](const std::string& more, const std::string& says) {
    expectFails(mapCommand(output, archive, "--resume " + more, street), 3,
                archive + ": is the archive of another run: " + says);
    EXPECT_TRUE(bytesOf(archive) == bytes) << "nothing committed is lost";
  };
  refuses("--crf-temperature 9", "crf_temperature was 3");
  refuses("--network-every 2", "network_every was 1");
  refuses("--also depth", "also was none, is [depth]");
  refuses("--frames 0:10", "frames was 11, from 0 to 10, is 10, from 0 to 9");
  setWord(street + "/poses.txt", 11, 12, "0.25");
  refuses("", "poses was ");
  fs::copy(thereAndBack() + "/poses.txt", street + "/poses.txt",
           fs::copy_options::overwrite_existing);
  for (const std::size_t line : {1, 2, 3, 4})
    setWord(street + "/calib.txt", line, 2, "121");
  refuses("", "camera was ");
}

TEST_F(ArchivedRun, OtherDataBehindTheSamePathsIsRefused)
{
  const TemporaryFolder copies;
  const std::string street = copies.path("street");
  fs::copy(thereAndBack(), street, fs::copy_options::recursive);
  const std::string output = copies.path("out"), archive = copies.path("run.map");
  succeed(mapCommand(output, archive, "", street));
  const auto isRefused = [&](const std::string& changed, const std::string& other,
                             const std::string& says) {
    fs::copy(street + other, street + changed, fs::copy_options::overwrite_existing);
    expectFails(mapCommand(output, archive, "--resume", street), 3, says);
    EXPECT_TRUE(verifyArchive(archive).empty());
    fs::copy(thereAndBack() + changed, street + changed,
             fs::copy_options::overwrite_existing);
  };
  isRefused("/image_3/000000.png", "/image_3/000001.png",
            "run.map: frame 0 changed since the archived run");
  isRefused("/image_2/000005.png", "/image_2/000001.png",
            "run.map: frame 5 changed since the archived run");
  isRefused("/labels/000010.bin", "/labels/000003.bin",
            "run.map: labels of frame 10 changed since");
  succeed(mapCommand(output, archive, "--resume", street));
}

TEST_F(ArchivedRun, TheImagesOfEarlierFramesHaveToBeThere)
{
  expectFails(mapCommand(folder_.path("other"), whole_archive_, "--resume"), 3,
              "labels/000000.png: is missing; resume with the --output");
  EXPECT_FALSE(fs::exists(folder_.path("other")));
}

} // namespace pcl_semantic
