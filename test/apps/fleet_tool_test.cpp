// SPDX-License-Identifier: BSD-3-Clause

// pcl_semantic_fleet, on one machine and under mpirun.

#include "support/mapped_street.h"
#include "support/thrown_message.h"

#include <pcl_semantic/io/map_archive.h>

#include <fstream>
#include <functional>
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

TEST_F(Fleet, SaysWhatIsDoubtfulOfCorrectedPosesOnce)
{
  std::string rows;
  for (int frame = 0; frame < 3; ++frame)
    rows += "1.001 0 0 0 0 -1 0 0 0 0 -1 0.8\n"; // not quite rigid, and upside down
  const std::string poses = folder_.write("corrected.txt", rows);
  const std::string said =
      succeed("fleet " + writePlan("city", ", corrected_poses: " + poses));
  for (const char* const doubt :
       {"corrected.txt: 3 of 3 poses were not exactly rigid", "upside down"}) {
    EXPECT_TRUE(holds(said, doubt));
    EXPECT_EQ(said.find(doubt), said.rfind(doubt)) << said;
  }
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
           {3, "'nonsense' is no option of a drive", begin + ", nonsense: 3}\n"},
           {2, "drive 'a': --submap-every", begin + ", submap_every: 3x}\n"},
           {2, "drive 'a': --poses viewpoint and --submap-every",
            "output: none\ndrives:\n  - {name: a, clouds: " + street +
                ", poses: viewpoint}\n"},
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
           {3, "'maybe', expected false or true", begin + ", strict: maybe}\n"}})
    expectFails(plan(text), code, says);
  EXPECT_FALSE(fs::exists(folder_.path("none")));
}

// Plan A in a folder, then plan B in the same, against plan B alone.
class ChangedFleet : public Fleet {
protected:
  struct Case {
    std::string name, before, after;
    std::function<void()> change = nullptr; ///< of the inputs, in between
    std::function<void()> damage = nullptr; ///< of what plan A has made
  };

  std::string
  drive(const std::string& name, const std::string& frames,
        const std::string& more = "") const
  {
    return "  - {name: " + name + ", frames: '" + frames + "', sequence: " + street_ +
           more + "}\n";
  }

  // Options that are not given are such that it takes little time.
  std::string
  plan(const std::string& drives, const std::string& options = "") const
  {
    std::string all = "labels: " + street_ + "/labels" + options;
    for (const std::string option :
         {"submap_every: 1", "voxel_size: 0.2", "max_depth: 15", "crf: none"})
      if (!holds(options, option.substr(0, option.find(':'))))
        all += ", " + option;
    return "output: city\noptions: {" + all + "}\ndrives:\n" + drives;
  }

  // KITTI's poses, all of them moved to the right.
  std::string
  writePoses(const std::string& name, double right) const
  {
    std::string text;
    for (int frame = 0; frame < 3; ++frame)
      text += "1 0 0 " + std::to_string(right) + " 0 1 0 0 0 0 1 " +
              std::to_string(frame) + "\n";
    return folder_.write(name, text);
  }

  std::string
  run(const std::string& folder, const std::string& plan) const
  {
    fs::create_directories(folder_.path(folder));
    return succeed("fleet " + folder_.write(folder + "/plan.yaml", plan));
  }

  // One byte of a file is another one.
  static void
  damage(const std::string& path, std::size_t at)
  {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(std::streamoff(at));
    const char byte = char(file.get());
    file.seekp(std::streamoff(at));
    file.put(char(byte ^ 0x55));
    ASSERT_TRUE(file.good()) << path;
  }

  // The folder that a plan alone makes: once of the same inputs.
  std::string
  made(const std::string& plan, bool anew = false) const
  {
    const std::string folder =
        anew ? "new" : "made/" + std::to_string(std::hash<std::string>()(plan));
    if (anew)
      fs::remove_all(folder_.path(folder));
    if (!fs::exists(folder_.path(folder)))
      run(folder, plan);
    return folder_.path(folder);
  }

  void
  expectSame(const Case& each)
  {
    SCOPED_TRACE(each.name);
    copyStreet(street_);
    fs::remove_all(folder_.path("used"));
    fs::copy(made(each.before), folder_.path("used"), fs::copy_options::recursive);
    for (const auto& happens : {each.change, each.damage})
      if (happens)
        happens();
    run("used", each.after);
    const std::string used = folder_.path("used/city"),
                      fresh = made(each.after, bool(each.change)) + "/city";
    EXPECT_EQ(mapIn(used), mapIn(fresh));
    EXPECT_EQ(filesIn(used), filesIn(fresh));
    const auto columns = [](const std::string& log) {
      std::vector<std::string> tasks;
      for (const std::string& line : linesOf(log))
        tasks.push_back(line.substr(0, line.find(',')));
      return tasks;
    };
    EXPECT_EQ(columns(used + "/log.csv"), columns(fresh + "/log.csv"));
  }

  const std::string street_ = folder_.path("street");
};

TEST_F(ChangedFleet, IsThatOfItsPlan)
{
  const std::string a = drive("a", "0:1"), b = drive("b", "1:3"), both = plan(a + b),
                    refined = plan(a + b, ", crf: dense"),
                    near = writePoses("near.txt", 0.3),
                    far = writePoses("far.txt", 300),
                    placed = plan(a + drive("b", "1:3", ", corrected_poses: " + near)),
                    whole = plan(drive("a", "0:3"), ", submap_every: 3");
  std::string classes = bytesOf(kitti11);
  const std::string kitti = folder_.write("kitti.yaml", classes);
  classes.replace(classes.find("building"), 8, "dwelling");
  const std::string others = folder_.write("others.yaml", classes);
  const auto copyFile = [&](const std::string& from, const std::string& to) {
    fs::copy_file(street_ + from, street_ + to, fs::copy_options::overwrite_existing);
  };
  // The second of two frames is another one: neither the first nor the last of three.
  const auto middle = [&](const std::string& kind, const std::string& extension) {
    return [=] {
      copyFile("/" + kind + "/000000" + extension, "/" + kind + "/000001" + extension);
    };
  };
  const std::string tile_of_used = folder_.path("used/city/tiles/");
  const auto firstTile = [=] {
    std::set<fs::path> tiles;
    for (const auto& file : fs::directory_iterator(tile_of_used))
      if (file.path().extension() == ".map")
        tiles.insert(file.path());
    return tiles.begin()->string();
  };
  for (const Case& each : std::vector<Case>{
           {"nothing", both, both},
           {"drive added", plan(b), both},
           {"drive added behind", plan(a), both},
           {"first drive removed", both, plan(b)},
           {"last drive removed", both, plan(a)},
           {"drive renamed", both, plan(a + drive("c", "1:3"))},
           {"drives reordered", both, plan(b + a)},
           {"drive shortened", both, plan(a + drive("b", "1:2"))},
           {"drive lengthened", plan(a + drive("b", "1:2")), both},
           {"drive begins later", both, plan(a + drive("b", "2:3"))},
           {"corrected poses added", both, placed},
           {"corrected poses changed", placed, placed,
            [&] { writePoses("near.txt", 0.6); }},
           {"corrected poses removed", placed, both, [&] { writePoses("near.txt", 0.3); }},
           {"submaps moved out of reach", both,
            plan(a + drive("b", "1:3", ", corrected_poses: " + far))},
           {"poses changed", both, both,
            [&] { setWord(street_ + "/poses.txt", 2, 4, "0.7"); }},
           {"other poses", both, plan(a + b, ", poses: " + near)},
           {"labels changed", whole, whole, middle("labels", ".bin")},
           {"labels changed without a trace", whole, whole,
            [&] {
              const std::string path = street_ + "/labels/000001.bin";
              const auto time = fs::last_write_time(path);
              middle("labels", ".bin")();
              fs::last_write_time(path, time);
            }},
           {"left image changed", whole, whole, middle("image_2", ".png")},
           {"right image changed", whole, whole, middle("image_3", ".png")},
           {"calibration changed", both, both,
            [&] { for (const std::size_t line : {3, 4})
                setWord(street_ + "/calib.txt", line, 2, "180"); }},
           {"label set changed", plan(a + b, ", label_set: " + kitti),
            plan(a + b, ", label_set: " + others)},
           {"label set of that name changed", plan(a + b, ", label_set: " + kitti),
            plan(a + b, ", label_set: " + kitti),
            [&] { fs::copy_file(others, kitti, fs::copy_options::overwrite_existing); }},
           {"voxel size, and with it tiles", both, plan(a + b, ", voxel_size: 0.3")},
           {"longer submaps", both, plan(a + b, ", submap_every: 2")},
           {"map option", both, plan(a + b, ", max_depth: 12")},
           {"option of one drive", both, plan(a + drive("b", "1:3", ", max_depth: 12"))},
           {"option of the CRF", refined, plan(a + b, ", crf: dense, crf_iterations: 2")},
           {"no CRF", refined, both},
           {"last drive removed, with the CRF", refined, plan(a, ", crf: dense")},
           {"a tile is damaged", both, both, {}, [&] { damage(firstTile(), 9000); }},
           {"a tile is lost", both, both, {}, [&] { fs::remove(firstTile()); }},
           {"a submap is damaged", both, both, {},
            [&] {
              const std::string path =
                  folder_.path("used/city/submaps/b/000002.map");
              damage(path, fs::file_size(path) / 2);
            }},
           {"a submap is no archive", both, both, {},
            [&] { folder_.write("used/city/submaps/b/000002.map", "nothing"); }},
           {"a submap is lost", both, both, {},
            [&] { fs::remove(folder_.path("used/city/submaps/b/000002.map")); }}})
    expectSame(each);
}

TEST_F(ChangedFleet, MakesOnlyWhatHasChanged)
{
  copyStreet(street_);
  const std::string a = drive("a", "0:1"), b = drive("b", "1:3");
  run("used", plan(a + b));
  const std::string first = folder_.path("used/city/submaps/a/000000.map");
  const auto made = fs::last_write_time(first);
  run("used", plan(a));
  EXPECT_EQ(fs::last_write_time(first), made);
  EXPECT_FALSE(fs::exists(folder_.path("used/city/submaps/b")));
  // Foreign files are kept.
  folder_.write("used/city/submaps/notes.txt", "mine");
  fs::create_directories(folder_.path("used/city/submaps/b"));
  folder_.write("used/city/submaps/b/notes.txt", "mine");
  folder_.write("used/city/tiles/notes.txt", "mine");
  run("used", plan(a));
  for (const char* const name :
       {"submaps/notes.txt", "submaps/b/notes.txt", "tiles/notes.txt"})
    EXPECT_TRUE(fs::exists(folder_.path("used/city/") + name)) << name;
}

} // namespace

} // namespace pcl_semantic
