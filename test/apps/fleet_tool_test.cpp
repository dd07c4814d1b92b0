// SPDX-License-Identifier: BSD-3-Clause

// pcl_semantic_fleet, on one machine and under mpirun.

#include "support/mapped_street.h"
#include "support/thrown_message.h"

#include <pcl_semantic/io/map_archive.h>

#include <map>
#include <tuple>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

class Fleet : public testing::Test {
protected:
  // Two drives over the tiny street, in submaps of a frame each.
  std::string
  writePlan(const std::string& name, const std::string& more = "") const
  {
    const std::string street = tinyStreet();
    const std::string drive =
        ", sequence: " + street + ", labels: " + street + "/labels" + more;
    return folder_.write(name + ".yaml",
                         "output: " + name +
                             "\noptions: {submap_every: 1, voxel_size: 0.2}" +
                             "\ndrives:\n  - {name: begin, frames: '0:1'" + drive +
                             "}\n  - {name: end, frames: '1:3'" + drive + "}\n");
  }

  static bool
  hasMpi()
  {
    return runShell("command -v mpirun && ldd " PCL_SEMANTIC_BINARY_DIR
                    "/bin/pcl_semantic_fleet | grep libmpi")
               .code == 0;
  }

  static ToolResult
  runRanks(int ranks, const std::string& plan)
  {
    return runShell(
        "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun -n " +
        std::to_string(ranks) +
        " --oversubscribe " PCL_SEMANTIC_BINARY_DIR "/bin/pcl_semantic_fleet " + plan +
        " 2>&1");
  }

  // The bytes of index and tiles, by name; paths in the archives are relative to a
  // plan.
  static std::map<std::string, std::string>
  mapIn(const std::string& folder)
  {
    std::map<std::string, std::string> files = {
        {"map.tiles", bytesOf(folder + "/map.tiles")}};
    for (const auto& file : fs::directory_iterator(folder + "/tiles"))
      files[file.path().filename().string()] = bytesOf(file.path().string());
    return files;
  }

  TemporaryFolder folder_;
};

TEST_F(Fleet, MapsDrivesIntoOneMapInTiles)
{
  const std::string plan = writePlan("city"), city = folder_.path("city");
  const std::string text = succeed("fleet " + plan);
  EXPECT_TRUE(holds(text, "submaps: 3\n"));
  EXPECT_TRUE(holds(text, "map: " + city + "/map.tiles\n"));
  const std::string log = bytesOf(city + "/log.csv");
  EXPECT_EQ(log.rfind("task,rank,seconds\ncity/submaps/begin/000000.map,0,", 0), 0u);
  EXPECT_TRUE(holds(succeed("archive verify " + city + "/map.tiles"), "ok"));
  // The same as one map of all submaps.
  std::string submaps;
  for (const char* const name : {"begin/000000", "end/000001", "end/000002"})
    submaps += city + "/submaps/" + name + ".map ";
  const std::string whole = folder_.path("whole.map");
  succeed("archive merge " + submaps + whole);
  const std::unique_ptr<MapReader> a = MapReader::open(city + "/map.tiles");
  const MapArchive b(whole, ArchiveAccess::read);
  EXPECT_EQ(a->state().blocks, b.state().blocks);
  EXPECT_GT(b.state().blocks, 500u);
  b.forEach([&](const VoxelIndex& index, const VoxelBlock& block) {
    const std::unique_ptr<VoxelBlock> other = std::move(a->get({index}).front());
    ASSERT_TRUE(other);
    EXPECT_EQ(other->log_odds, block.log_odds);
    ASSERT_EQ(other->refined.size(), block.refined.size());
    for (std::size_t i = 0; i < block.refined.size(); ++i)
      ASSERT_NEAR(other->refined[i], block.refined[i], 1e-2) << "weights of 8 bits";
  });
  for (const std::string& command :
       {"export " + city + "/map.tiles " + folder_.path("city.ply"),
        "render " + city + "/map.tiles " + folder_.path("city.png"),
        "archive export " + city + "/map.tiles " + folder_.path("city.pcd")})
    succeed(command);
  // Again: nothing is done twice, and another plan leaves no tile behind.
  const auto before = mapIn(city);
  const auto made = fs::last_write_time(city + "/submaps/end/000002.map");
  folder_.write("city/tiles/99_99.map", "of an earlier plan");
  succeed("fleet " + plan);
  EXPECT_EQ(mapIn(city), before);
  EXPECT_EQ(bytesOf(city + "/log.csv"), log) << "what was done before keeps its costs";
  EXPECT_EQ(fs::last_write_time(city + "/submaps/end/000002.map"), made);
}

TEST_F(Fleet, GivesTheSameBytesWhoeverDoesTheWork)
{
  if (!hasMpi())
    GTEST_SKIP() << "MPI is not installed";
  const std::string plan = writePlan("city"), city = folder_.path("city");
  succeed("fleet " + plan);
  const auto alone = mapIn(city);
  EXPECT_GT(alone.size(), 2u);
  for (const int ranks : {2, 3}) {
    fs::remove_all(city);
    const ToolResult result = runRanks(ranks, plan);
    EXPECT_EQ(result.code, 0) << result.text;
    EXPECT_TRUE(holds(result.text, "submaps: 3\n"));
    EXPECT_EQ(mapIn(city), alone) << ranks;
  }
  // One that died left this: a submap that is finished, one begun, and a part of a
  // tile.
  fs::remove(city + "/submaps/end/000002.map");
  fs::remove(city + "/map.tiles");
  fs::remove(city + "/tiles/" + std::next(alone.begin())->first);
  EXPECT_EQ(runRanks(2, plan).code, 0);
  EXPECT_EQ(mapIn(city), alone);
  // An error of one ends all.
  const ToolResult bad = runRanks(2, writePlan("bad", ", poses: nowhere.txt"));
  EXPECT_EQ(bad.code, 3) << bad.text;
  EXPECT_TRUE(holds(bad.text, "drive 'begin': nowhere.txt: cannot be read"));
  EXPECT_EQ(bad.text.find("pcl_semantic_fleet: "),
            bad.text.rfind("pcl_semantic_fleet: "));
}

TEST_F(Fleet, RefusesWhatCannotBe)
{
  const std::string street = tinyStreet();
  const std::string begin = "output: none\ndrives:\n  - {name: a, sequence: " + street +
                            ", labels: " + street + "/labels";
  const auto plan = [&](const std::string& text) {
    return "fleet " + folder_.write("plan.yaml", text);
  };
  const std::string second =
      "}\n  - {name: b, sequence: " + street + ", labels: " + street + "/labels, ";
  expectFails("fleet", 2, "PLAN.yaml is missing");
  expectFails("fleet " + folder_.path("none.yaml"), 3, "cannot be read");
  folder_.write("short.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  folder_.write("preset.yaml", "max_probability: 0.9\n");
  for (const auto& [code, says, text] :
       std::vector<std::tuple<int, std::string, std::string>>{
           {3, "drive 'a': nowhere: is no folder",
            "output: none\ndrives:\n  - {name: a, sequence: nowhere, labels: x}\n"},
           {2, "drive 'a': unrecognised option '--nonsense=3'",
            begin + ", nonsense: 3}\n"},
           {2, "drive 'a': --submap-every", begin + ", submap_every: 3x}\n"},
           {3, "drive 'a': nowhere.txt: cannot be read",
            begin + ", corrected_poses: nowhere.txt}\n"},
           {2, "drive 'b': has another voxel size than the first drive",
            begin + second + "voxel_size: 0.3}\n"},
           {2, "drive 'b': has another label set than the first drive",
            begin + second +
                "label_set: " PCL_SEMANTIC_SOURCE_DIR
                "/data/label_sets/cityscapes19.yaml}\n"},
           {3, "drive 'a': short.txt: has 1 poses, none for frame 1",
            begin + ", submap_every: 2, corrected_poses: short.txt}\n"},
           {2, "drive 'b': has another min_probability, max_probability",
            begin + second + "config: " + folder_.path("preset.yaml") + "}\n"},
           {2, "strict is 'maybe'", begin + ", strict: maybe}\n"}})
    expectFails(plan(text), code, says);
  EXPECT_FALSE(fs::exists(folder_.path("none")));
  const std::string other = writePlan("city");
  succeed("fleet " + other);
  writePlan("city", ", max_depth: 20");
  expectFails("fleet " + other, 3, "is the archive of another run: max_depth was ");
}

} // namespace

} // namespace pcl_semantic
