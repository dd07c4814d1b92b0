// SPDX-License-Identifier: BSD-3-Clause

// pcl_semantic_archive, and errors of pcl_semantic_map about unusable archives.

#include "files/pcd_file.h"
#include "support/map_agreement.h"
#include "support/mapped_street.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/trajectory_file.h>
#include <pcl_semantic/io/map_archive.h>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

class StreetArchive : public testing::Test {
protected:
  static void
  SetUpTestSuite()
  {
    folder_ = std::make_unique<TemporaryFolder>();
    output_ = folder_->path("out");
    archive_ = folder_->path("street.map");
    const std::string text = succeed(mapCommand(output_, "--archive " + archive_));
    EXPECT_TRUE(holds(text, "\narchive: " + archive_ + "\n"));
  }

  static std::string
  mapCommand(const std::string& output, const std::string& options)
  {
    return mapOf(tinyStreet()) + " --voxel-size 0.2 --output " + output + " " + options;
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::string output_, archive_;
};

} // namespace

TEST_F(StreetArchive, InfoAndVerify)
{
  const nlohmann::json summary = readJson(output_ + "/summary.json");
  const std::string info = succeed("archive info " + archive_);
  for (const std::string& part :
       {"file: " + archive_ + "\nbytes: " + std::to_string(fs::file_size(archive_)) +
            "\n",
        std::string("\nrun: finished\nframes: 3\nlast_frame: 2\nvoxel_size: 0.2\n"),
        std::string("sidewalk car pedestrian"),
        "\noccupied: " + summary["voxels"].dump() + "\nfrom: ",
        std::string("\nmade_from:\n"), std::string("\nvoxel_size: 0.2\n")})
    EXPECT_TRUE(holds(info, part));
  const auto json =
      nlohmann::json::parse(runTool("archive info --json " + archive_).text);
  EXPECT_EQ(json["bytes"], fs::file_size(archive_));
  EXPECT_EQ(json["occupied"], summary["voxels"]);
  EXPECT_TRUE(holds(succeed("archive verify " + archive_), "ok\n"));

  std::string bytes = bytesOf(archive_);
  const std::size_t frame = bytes.find("\x28\xB5\x2F\xFD", bytes.size() / 2); // of zstd
  ASSERT_NE(frame, std::string::npos);
  bytes[frame + 40] = char(bytes[frame + 40] ^ 4);
  const std::string damaged = folder_->write("damaged.map", bytes);
  const ToolResult verified = runTool("archive verify " + damaged);
  EXPECT_EQ(verified.code, 3);
  EXPECT_TRUE(holds(verified.text, damaged + ": block "));
  EXPECT_TRUE(holds(verified.text, damaged + ": 1 faults\n"));
  expectFails("archive export " + damaged + " " + folder_->path("no.pcd"), 3, "block ");
  EXPECT_FALSE(fs::exists(folder_->path("no.pcd")));
  expectFails("archive verify " + folder_->path("none"), 3, "No such file");
  expectFails("archive info " + tinyStreet() + "/poses.txt", 3, "is no map archive");
}

TEST_F(StreetArchive, ExportOfAllOfABoxAndOfClasses)
{
  const std::string all = folder_->path("all.pcd");
  EXPECT_TRUE(holds(succeed("archive export " + archive_ + " " + all + " --planes " +
                            folder_->path("all.json")),
                    "voxels: "));
  EXPECT_TRUE(bytesOf(all) == bytesOf(output_ + "/map.pcd"));
  succeed("archive export " + archive_ + " " + all); // without planes
  const PcdTable map = readPcd(all);
  const std::size_t size = std::size_t(map.point_step);
  const PcdColumn x(map, 0), y(map, 1), z(map, 2), label(map, map.find("label"));
  const auto chosen = [&](const auto& is_chosen) {
    std::string data;
    for (std::size_t i = 0; i < map.points(); ++i)
      if (is_chosen(i))
        data.append(map.data.begin() + long(i * size),
                    map.data.begin() + long((i + 1) * size));
    return data;
  };
  const auto exported = [&](const std::string& options) {
    const std::string path = folder_->path("part.pcd");
    EXPECT_TRUE(holds(succeed("archive export " + archive_ + " " + path + options),
                      "voxels: "));
    const PcdTable part = readPcd(path);
    return std::string(part.data.begin(), part.data.end());
  };
  const auto inBox = [&](std::size_t i) {
    return x(i) >= 6 && x(i) < 12 && y(i) >= -4 && y(i) < 3 && z(i) >= -2.5 && z(i) < 1;
  };
  const std::string box = " --box 6,-4,-2.5,12,3,1";
  EXPECT_TRUE(exported(box) == chosen(inBox));
  succeed("cloud " + all + " " + folder_->path("cropped.pcd") +
          " --crop 6,-4,-2.5,12,3,1");
  const PcdTable cropped = readPcd(folder_->path("cropped.pcd"));
  EXPECT_TRUE(exported(box) == std::string(cropped.data.begin(), cropped.data.end()));
  EXPECT_TRUE(exported(" --class road --class car") ==
              chosen([&](std::size_t i) { return label(i) == 3 || label(i) == 6; }));
  const std::string road =
      chosen([&](std::size_t i) { return inBox(i) && label(i) == 3; });
  EXPECT_GT(road.size(), 10 * size);
  EXPECT_LT(road.size(), chosen(inBox).size());
  EXPECT_TRUE(exported(box + " --class road") == road);
  EXPECT_TRUE(exported(" --box 900,0,0,901,1,1").empty());
}

TEST_F(StreetArchive, Merge)
{
  // Freed voxels are not sums.
  const std::string sums = folder_->write("sums.yaml", "free_dynamic: false\n");
  const std::string first = folder_->path("first.map"),
                    rest = folder_->path("rest.map"), all = folder_->path("all.map");
  for (const auto& [path, frames] :
       {std::pair{first, "0:1"}, std::pair{rest, "1:3"}, std::pair{all, "0:3"}})
    succeed(mapCommand(folder_->path("part"), std::string("--frames ") + frames +
                                                  " --config " + sums + " --archive " +
                                                  path));
  const std::string joined = folder_->path("joined.map");
  EXPECT_TRUE(
      holds(succeed("archive merge " + first + " " + rest + " " + joined), "blocks: "));
  EXPECT_TRUE(holds(succeed("archive verify " + joined), "ok"));
  // What several frames know is the same, whether they were merged or mapped.
  const MapArchive a(all, ArchiveAccess::read), b(joined, ArchiveAccess::read);
  EXPECT_EQ(a.state().blocks, b.state().blocks);
  std::size_t same = 0, voxels = 0;
  a.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    const auto other = b.get(index);
    ASSERT_TRUE(other);
    for (int place = 0; place < kBlockVoxels; ++place) {
      const int i = block.recordAt(place), j = other->recordAt(place);
      ASSERT_EQ(i < 0, j < 0);
      if (i >= 0) {
        ASSERT_EQ(block.records[std::size_t(i)].colour_sum,
                  other->records[std::size_t(j)].colour_sum);
        ASSERT_EQ(block.records[std::size_t(i)].observations,
                  other->records[std::size_t(j)].observations);
      }
      ++voxels;
      same += block.log_odds[std::size_t(place)] == other->log_odds[std::size_t(place)];
    }
  });
  EXPECT_EQ(same, voxels) << "three frames do not reach the clamps";

  const std::string coarse = folder_->path("coarse.map");
  const std::string config = folder_->write("coarse.yaml", "voxel_size: 0.25\n");
  succeed(mapOf(tinyStreet()) + " --frames 0:1 --output " + folder_->path("part") +
          " --archive " + coarse + " --config " + config);
  expectFails("archive merge " + first + " " + coarse + " " + folder_->path("no.map"),
              3, coarse + ": has another voxel size than " + first);
  EXPECT_FALSE(fs::exists(folder_->path("no.map")));
}

TEST_F(StreetArchive, SubmapsAreMergedToTheMapOfTheDrive)
{
  const std::string submaps = folder_->path("submaps");
  const std::string command = mapCommand(submaps, "--map-only --submap-every 2");
  EXPECT_TRUE(holds(succeed(command), "submaps: 2\narchives: " + submaps + "/*.map\n"));
  const std::string first = submaps + "/000000.map", second = submaps + "/000002.map";
  EXPECT_EQ(MapArchive(first, ArchiveAccess::read).state().frames, 2u);
  EXPECT_EQ(MapArchive(second, ArchiveAccess::read).state().last_frame, 2);
  EXPECT_TRUE(fs::exists(submaps + "/000002/map.pcd"));
  expectFails(command, 5, first + ": is there already");
  succeed(command + " --resume");

  const std::string joined = folder_->path("drive.map");
  succeed("archive merge " + first + " " + second + " " + joined);
  const Agreement agreement = agreementOf(archive_, joined);
  EXPECT_GT(agreement.occupied, 3000u);
  EXPECT_GE(agreement.occupancy, 0.995);
  EXPECT_GE(agreement.labels, 0.995);
}

TEST_F(StreetArchive, SubmapsMoveWithTheirPoses)
{
  // Each pose is off by another way; a submap of each frame takes that back.
  Trajectory poses = readKittiTrajectory(tinyStreet() + "/poses.txt");
  for (std::size_t i = 0; i < poses.size(); ++i)
    poses[i].pretranslate(Eigen::Vector3d(0.9 - double(i), 0.4, 0.7 * double(i)));
  const std::string drifted = folder_->path("drifted.txt"),
                    submaps = folder_->path("moved"),
                    joined = folder_->path("corrected.map");
  writeKittiTrajectory(drifted, poses);
  succeed(mapCommand(submaps, "--map-only --submap-every 0.5m --poses " + drifted));
  const std::string files =
      submaps + "/000000.map " + submaps + "/000001.map " + submaps + "/000002.map ";
  succeed("archive merge " + files + joined + " --poses " + tinyStreet() +
          "/poses.txt");
  const std::string wrong = folder_->path("wrong.map");
  succeed("archive merge " + files + wrong);
  // Whole voxels are moved by parts of one: some of a surface go to the next layer.
  const Agreement corrected = agreementOf(archive_, joined);
  EXPECT_GE(corrected.near, 0.98);
  EXPECT_GE(agreementOf(joined, archive_).near, 0.98);
  EXPECT_GE(corrected.occupancy, 0.98);
  EXPECT_GE(corrected.labels, 0.95);
  EXPECT_LT(agreementOf(archive_, wrong).near, 0.7);
  EXPECT_TRUE(holds(succeed("archive changes " + archive_ + " " + archive_ + " " +
                            folder_->path("changes.pcd")),
                    "went: 0\ncame: 0\n"));
  const std::string changed = succeed("archive changes " + archive_ + " " + wrong +
                                      " " + folder_->path("changes.pcd"));
  EXPECT_TRUE(!holds(changed, "went: 0\n") && !holds(changed, "came: 0\n")) << changed;
  expectFails("archive changes " + archive_ + " " + wrong, 2, "'changes' needs BEFORE");
  fs::remove(joined);
  expectFails("archive merge " + files + joined + " --poses " + drifted + " --poses " +
                  drifted,
              2, "--poses is given once, or as often as there are FILEs");
  expectFails("archive info " + archive_ + " --poses " + drifted, 2,
              "--poses is for 'merge' and 'changes'");
  EXPECT_FALSE(fs::exists(joined));
}

TEST_F(StreetArchive, BadUsage)
{
  const std::string out = folder_->path("x");
  for (const auto& [command, says] : std::vector<std::pair<std::string, std::string>>{
           {"archive", "expected info, verify, export, merge or changes"},
           {"archive copy " + archive_, "'copy': expected info"},
           {"archive info", "'info' needs one FILE"},
           {"archive info " + archive_ + " " + archive_, "'info' needs one FILE"},
           {"archive verify", "'verify' needs one FILE"},
           {"archive export " + archive_, "'export' needs FILE and OUT.pcd"},
           {"archive export " + archive_ + " " + archive_, "given as an output"},
           {"archive export " + archive_ + " " + out + " --box 1,2,3", "six numbers"},
           {"archive export " + archive_ + " " + out + " --box 1,2,3,4,5,6,7",
            "six numbers"},
           {"archive export " + archive_ + " " + out + " --box 1,2,3,a,5,6",
            "six numbers"},
           {"archive export " + archive_ + " " + out + " --box 1,2,3,0,5,6",
            "six numbers"},
           {"archive info " + archive_ + " --box 1,2,3,4,5,6", "are for 'export'"},
           {"archive merge " + archive_ + " " + out, "two FILEs or more"},
           {"archive merge " + archive_ + " " + archive_ + " " + out,
            "is named twice, and would be believed twice"},
           {"archive info " + archive_ + " --fast", "'--fast'"},
           {mapCommand(out, "--submap-every 2 --archive " + out + ".map"),
            "--submap-every and --archive or --view exclude each other"},
           {mapCommand(out, "--submap-every 2 --poses odometry"),
            "--submap-every needs poses from a file"},
           {mapCommand(out, "--resume"), "--resume needs --archive"},
           {mapCommand(out, "--archive-every 0"), "--archive-every"},
           {mapCommand(out, "--archive " + out + "/map.pcd"),
            "is a path that --output writes"},
           {mapCommand(out, "--archive " + out + "/labels/run.map"),
            "is a path that --output writes"},
           {mapCommand(out, "--archive " + out + "/../x/summary.json"),
            "is a path that --output writes"}})
    expectFails(command, 2, says);
  for (const char* const length : {"0", "-3m", "2.5", "5x", "m", "nan", "1e30m"})
    expectFails(mapCommand(out, std::string("--submap-every ") + length), 2,
                "--submap-every");
  expectFails("archive export " + archive_ + " " + out + " --class bicycle", 3,
              archive_ + ": has no class 'bicycle'");
  EXPECT_FALSE(fs::exists(out));
}

TEST_F(StreetArchive, ArchivesThatCannotBeWritten)
{
  const std::string out = folder_->path("y");
  const auto fails = [&](const std::string& options, int code,
                         const std::string& says) {
    expectFails(mapCommand(out, options), code, says);
  };
  const std::string bytes = bytesOf(archive_);
  fails("--archive " + archive_, 5, archive_ + ": is there already; continue it with");
  EXPECT_TRUE(bytesOf(archive_) == bytes);
  const std::string file = folder_->write("file", "");
  fails("--archive " + file + "/a.map", 5, file + ": cannot be made");
  fails("--resume --archive " + folder_->path(), 3, "is a folder");
  fails("--resume --archive " + folder_->write("text", "hello"), 3, "no map archive");
  {
    const MapArchive writer(archive_, ArchiveAccess::write);
    fails("--resume --archive " + archive_, 5, "another program is writing it");
  }
  // A run that fails before its first frame leaves no archive in the way of the next.
  const std::string fresh = folder_->path("fresh.map");
  fails("--window 99999,99999,99999 --archive " + fresh, 2, "too large");
  EXPECT_FALSE(fs::exists(fresh));
}

TEST_F(StreetArchive, AnArchiveMayLieInANewFolder)
{
  for (const char* const name : {"new/run.map", "deep/run.map"}) {
    const std::string archive = folder_->path(name), out = folder_->path("new");
    EXPECT_TRUE(
        holds(succeed(mapCommand(out, "--frames 0:1 --archive " + archive)), archive));
    EXPECT_TRUE(verifyArchive(archive).empty());
  }
}

// The disk is full from some point of the run on, wherever that is.
TEST_F(StreetArchive, AFullDiskLosesNothingCommitted)
{
  int failed = 0;
  std::uint64_t most_frames = 0;
  for (int kilobytes = 16; kilobytes < 2000; kilobytes = kilobytes * 3 / 2) {
    SCOPED_TRACE(kilobytes);
    const std::string out = folder_->path("full"), archive = folder_->path("full.map");
    fs::remove_all(out);
    fs::remove(archive);
    const std::string command =
        mapCommand(out, "--archive-every 1 --resume --archive " + archive);
    const ToolResult result =
        runTool(command, "trap '' XFSZ; ulimit -f " + std::to_string(kilobytes) + ";");
    failed += result.code == 5;
    EXPECT_TRUE(result.code == 5 || result.code == 0) << result.text;
    std::uint64_t frames = 0; // that have been committed
    if (result.code == 5 && fs::exists(archive)) {
      EXPECT_TRUE(verifyArchive(archive).empty());
      frames = MapArchive(archive, ArchiveAccess::read).state().frames;
    }
    most_frames = result.code == 5 ? std::max(most_frames, frames) : most_frames;
    const std::string resumed = "resumed_after: " + std::to_string(frames) + "\n";
    EXPECT_TRUE(holds(succeed(command),
                      result.code == 5 && frames > 0 ? resumed : "archive: "));
    EXPECT_TRUE(bytesOf(out + "/map.pcd") == bytesOf(output_ + "/map.pcd"));
  }
  EXPECT_GE(failed, 5);
  EXPECT_GE(most_frames, 1u) << "or none of them had anything to lose";
}

} // namespace pcl_semantic
