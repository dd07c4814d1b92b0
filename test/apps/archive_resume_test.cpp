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
  succeed("archive export " + archive + " " + path + " --planes " + path + ".json");
  return bytesOf(path);
}

// A run that nothing interrupts, made once.
struct WholeRun {
  WholeRun() { succeed(mapCommand(output, archive)); }

  TemporaryFolder folder;
  std::string output = folder.path("whole"), archive = folder.path("whole.map");
};

const WholeRun&
wholeRun()
{
  static const WholeRun run;
  return run;
}

class ArchivedRun : public testing::Test {
protected:
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
  const std::string output_ = folder_.path("out"), archive_ = folder_.path("run.map");
  const std::string &whole_ = wholeRun().output, &whole_archive_ = wholeRun().archive;
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
    fs::remove_all(output_);
    fs::remove(archive_);
    killed += kill(output_, archive_, files[i], int(random() % 50));
    if (i % 5 == 0) // once more, some frames later
      killed += kill(output_, archive_, files[std::min(i + 5, files.size() - 1)],
                     int(random() % 50));
    const ToolResult result = expectGoesOn(output_, archive_);
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
    fs::remove_all(output_);
    fs::remove(archive_);
    const ToolResult result =
        runShell(shellCommand(mapCommand(output_, archive_)) +
                 " 2>&1 & while kill -0 $! && ! test -e " + output_ + "/labels/00000" +
                 name + ".png; do sleep 0.01; done; kill -" + signal + " $!; wait $!");
    EXPECT_EQ(result.code, 130) << result.text;
    {
      const MapArchive interrupted(archive_, ArchiveAccess::read);
      EXPECT_FALSE(interrupted.state().finished);
      const nlohmann::json summary = readJson(output_ + "/summary.json");
      EXPECT_EQ(summary["finished"], false);
      const int written = summary["frames"];
      EXPECT_EQ(interrupted.state().frames, std::uint64_t(written))
          << "an interrupt commits the frames since the last commit";
      EXPECT_GT(written, frame);
      EXPECT_LT(written, frames);
      std::vector<std::string> names;
      for (int i = 0; i < written; ++i)
        names.push_back(frameFileName(i, ""));
      EXPECT_EQ(filesIn(output_), filesOfMap(names));
    }
    EXPECT_TRUE(holds(succeed("export " + output_ + " " + folder_.path(name + ".ply")),
                      "the run was interrupted; the map holds the frames up to then"));
    EXPECT_FALSE(fs::exists(archive_ + "-wal"));
    EXPECT_NE(runTool("archive info " + archive_).text.find("interrupted"),
              std::string::npos);
    expectGoesOn(output_, archive_);
  }
}

TEST_F(ArchivedRun, AFinishedRunStaysAsItIs)
{
  fs::copy(whole_, output_, fs::copy_options::recursive);
  fs::copy_file(whole_archive_, archive_);
  fs::remove(output_ + "/map.pcd");
  const ToolResult result = expectGoesOn(output_, archive_); // with a map.pcd again
  EXPECT_EQ(result.text.rfind("resumed_after: 11\n", 0), 0u) << result.text;
  // Also where nothing is left to map.
  succeed(mapCommand(output_, archive_, "--resume --map-only"));
  EXPECT_EQ(filesIn(output_), filesOfMap({}));
  EXPECT_FALSE(fs::exists(output_ + "/labels"));
}

TEST_F(ArchivedRun, ADifferentNumberOfThreadsMayGoOn)
{
  EXPECT_TRUE(kill(output_, archive_, "labels/000003.png", 0, "--threads 1"));
  succeed(mapCommand(output_, archive_, "--resume --threads 3"));
  EXPECT_TRUE(exportOf(archive_) == exportOf(whole_archive_));
}

TEST_F(ArchivedRun, WhatTheCrfWroteBackIsInTheArchive)
{
  const std::string more = "--config " +
                           folder_.write("back.yaml", "crf_write_back: true\n") +
                           " --network-every 3";
  const std::string whole = folder_.path("back.map");
  succeed(mapCommand(folder_.path("back"), whole, more));
  EXPECT_FALSE(exportOf(whole) == exportOf(whole_archive_));
  EXPECT_TRUE(kill(output_, archive_, "labels/000003.png", 0, more));
  // On another processor, too: all tiers give the same bits.
  succeed(mapCommand(output_, archive_, "--resume " + more), "PCL_SEMANTIC_SIMD=plain");
  EXPECT_TRUE(exportOf(archive_) == exportOf(whole));
}

TEST_F(ArchivedRun, WithoutImagesNoneAreLeft)
{
  EXPECT_TRUE(kill(output_, archive_, "labels/000003.png", 0));
  succeed(mapCommand(output_, archive_, "--resume --map-only"));
  EXPECT_FALSE(
      holds(succeed(mapCommand(folder_.path("plain"), "", "--map-only")), "overlay"));
  EXPECT_EQ(filesIn(folder_.path("plain")), filesOfMap({}));
  for (const char* const file : {"/map.pcd", "/trajectory.txt", "/top_view.png"})
    EXPECT_TRUE(bytesOf(folder_.path("plain") + file) == bytesOf(whole_ + file));
  EXPECT_TRUE(contentOf(output_) == contentOf(folder_.path("plain")));
  expectFails(mapCommand(output_, archive_, "--resume"), 3,
              "with --map-only if that run had it");
}

TEST_F(ArchivedRun, AnotherRunDoesNotGoOn)
{
  const std::string street = folder_.path("street");
  fs::copy(thereAndBack(), street, fs::copy_options::recursive);
  succeed(mapCommand(output_, archive_, "", street));
  const auto refuses = [&](const std::string& more, const std::string& says) {
    expectFails(mapCommand(output_, archive_, "--resume " + more, street), 3,
                archive_ + ": " + says);
    EXPECT_TRUE(verifyArchive(archive_).empty());
  };
  const auto copy = [&](const std::string& from, const std::string& name) {
    fs::copy(from, street + name, fs::copy_options::overwrite_existing);
  };
  for (const auto& [name, other, says] : // other data behind the same paths
       {std::tuple("/image_3/000000.png", "/image_3/000001.png",
                   "frame 0 changed since the archived run"),
        std::tuple("/image_2/000005.png", "/image_2/000001.png",
                   "frame 5 changed since the archived run"),
        std::tuple("/labels/000010.bin", "/labels/000003.bin",
                   "labels of frame 10 changed since")}) {
    copy(street + other, name);
    refuses("", says);
    copy(thereAndBack() + name, name);
  }
  succeed(mapCommand(output_, archive_, "--resume", street));
  const std::string bytes = bytesOf(archive_);
  const auto isAnother = [&](const std::string& more, const std::string& says) {
    refuses(more, "is the archive of another run: " + says);
    EXPECT_TRUE(bytesOf(archive_) == bytes) << "nothing committed is lost";
  };
  for (const auto& [option, says] :
       {std::pair("--crf-temperature 9", "crf_temperature was 3"),
        {"--network-every 2", "network_every was 1"},
        {"--also depth", "also was none, is [depth]"},
        {"--frames 0:10", "frames was 11, from 0 to 10, is 10, from 0 to 9"}})
    isAnother(option, says);
  setWord(street + "/poses.txt", 11, 12, "0.25");
  isAnother("", "poses was ");
  copy(thereAndBack() + "/poses.txt", "/poses.txt");
  for (const std::size_t line : {1, 2, 3, 4})
    setWord(street + "/calib.txt", line, 2, "121");
  isAnother("", "camera was ");
}

TEST_F(ArchivedRun, TheImagesOfEarlierFramesHaveToBeThere)
{
  expectFails(mapCommand(folder_.path("other"), whole_archive_, "--resume"), 3,
              "labels/000000.png: is missing; resume with the --output");
  EXPECT_FALSE(fs::exists(folder_.path("other")));
}

TEST_F(ArchivedRun, TheDepthsOfEarlierFramesHaveToBeThere)
{
  const std::string command =
      mapCommand(folder_.path("depths"), folder_.path("depths.map"), "--also depth ");
  succeed(command);
  fs::remove(folder_.path("depths/depth/000001.png"));
  expectFails(command + "--resume", 3,
              "depth/000001.png: is missing; resume with the --output");
}

} // namespace pcl_semantic
