// SPDX-License-Identifier: BSD-3-Clause
#include "support/ascii_cloud.h"
#include "support/bad_case.h"
#include "support/thrown_message.h"
#include "support/tiny_street.h"

#include <fstream>

namespace pcl_semantic {

namespace fs = std::filesystem;

namespace {

// A map of the tiny street, as folder, cloud and archive; made once.
class ExportedMap {
public:
  static const ExportedMap&
  instance()
  {
    static const ExportedMap map;
    return map;
  }

  std::string
  path(const std::string& name) const
  {
    return folder_.path(name);
  }

  /** \brief Exports one of its forms, and returns the file's bytes and the messages. */
  std::string
  exported(const std::string& form, const std::string& name,
           const std::string& options = "", std::string* said = nullptr) const
  {
    const std::string text =
        succeed("export " + path(form) + " " + path(name) + " " + options);
    if (said)
      *said = text;
    return bytesOf(path(name));
  }

private:
  ExportedMap()
  {
    succeed(mapOf(tinyStreet()) + " --crf none --output " + path("map") +
            " --archive " + path("archive"));
  }

  TemporaryFolder folder_;
};

// The number that follows a word.
long
numberAfter(const std::string& text, const std::string& word)
{
  const std::size_t at = text.find(word);
  EXPECT_NE(at, std::string::npos) << text;
  return at == std::string::npos ? -1 : std::stol(text.substr(at + word.size()));
}

std::size_t
countOf(const std::string& image, unsigned char shade)
{
  return std::size_t(std::count(image.begin(), image.end(), char(shade)));
}

BadCase::Damage
cloud(const std::string& fields, const std::string& points)
{
  return [=](const std::string& street) {
    std::ofstream(street + "/a.pcd") << asciiCloud("x:F8 y:F8 z:F8" + fields, points);
  };
}

} // namespace

TEST(ExportTool, WritesFoldersCloudsAndArchivesAlike)
{
  const ExportedMap& map = ExportedMap::instance();
  for (const auto& [name, options] :
       {std::pair("a.ply", ""), {"a.ply", "--colour rgb"}, {"a.pgm", ""}}) {
    SCOPED_TRACE(std::string(name) + " " + options);
    const std::string folder = map.exported("map", name, options);
    const std::string archive = map.exported("archive", name, options);
    EXPECT_GT(folder.size(), 300u);
    EXPECT_EQ(folder == archive, std::string(name) != "a.pgm"); // which has free space
    EXPECT_EQ(folder.size(), archive.size());
    EXPECT_EQ(folder.size(), map.exported("map/map.pcd", name, options).size());
  }
}

TEST(ExportTool, WritesTheVoxelsOfTheMap)
{
  const ExportedMap& map = ExportedMap::instance();
  std::string said;
  const std::string points = map.exported("map", "a.ply", "", &said);
  const long voxels = numberAfter(said, "voxels: ");
  EXPECT_GT(voxels, 1000);
  EXPECT_EQ(numberAfter(bytesOf(map.path("map/map.pcd")), "\nPOINTS "), voxels);
  EXPECT_EQ(numberAfter(points, "\nelement vertex "), voxels);
  EXPECT_EQ(long(points.size()), long(points.find("end_header\n")) + 11 + 19 * voxels);
}

TEST(ExportTool, KnowsFreeSpaceOfAnArchiveOnly)
{
  const ExportedMap& map = ExportedMap::instance();
  std::string of_folder, of_archive;
  const std::string tree = map.exported("map", "a.bt", "", &of_folder);
  EXPECT_LT(tree.size(), map.exported("archive", "a.bt", "", &of_archive).size());
  EXPECT_TRUE(holds(of_folder, "free_space: not known"));
  EXPECT_GT(numberAfter(of_archive, "free_voxels: "), 1000);
  EXPECT_EQ(tree.rfind("# Octomap OcTree binary file", 0), 0u);
  const std::string folder = map.exported("map", "a.pgm");
  const std::string archive = map.exported("archive", "a.pgm");
  EXPECT_EQ(countOf(folder, 0), countOf(archive, 0)); // the same obstacles
  EXPECT_GT(countOf(archive, 0), 10u);
  EXPECT_GT(countOf(archive, 254), 10u);
  // Of fewer classes there is less ground.
  EXPECT_LT(countOf(map.exported("map", "a.pgm", "--ground road"), 254),
            countOf(folder, 254));
}

TEST(BadUsage, ExportTool)
{
  const auto road = cloud(" label", "0.05 0.05 0.05 3\n0.15 0.05 0.05 3\n");
  const std::string in = "export STREET/a.pcd ";
  expectAllFail({
      {2, "MAP or OUT is missing", "export"},
      {2, "MAP or OUT is missing", in},
      {2, "expected a name that ends in .bt, .ply or .pgm", in + "OUT.csv"},
      {2, "--format was removed: the name of OUT", in + "OUT.ply --format mesh"},
      {2, "--traversable was removed: --ground names",
       in + "OUT.pgm --traversable=road"},
      {2, "--colour is 'red', expected class or rgb", in + "OUT.ply --colour red"},
      {2, "--colour has no effect without a .ply", in + "OUT.bt --colour rgb"},
      {2, "--ground has no effect without a .pgm", in + "OUT.ply --ground road"},
      {2, "--min-height", in + "OUT.pgm --min-height 3"},
      {2, "--min-height", in + "OUT.pgm --min-height nan"},
      {2, "--ground-reach", in + "OUT.pgm --ground-reach -1"},
      {2, "--voxel-size is less than 0", in + "OUT.ply --voxel-size -1"},
      {2, "--ground: the label set has no class 'lawn'",
       in + "OUT.pgm --ground road,lawn", road},
      {2, "is given as an output and a second time",
       in + "OUT.pgm --label-set OUT.yaml"},
      {3, "none.pcd: cannot be read", "export STREET/none.pcd OUT.ply"},
      {3, "a.las: is LAS, expected .pcd, .ply or .bin; convert it",
       "export STREET/a.las OUT.ply",
       [](const std::string& street) {
         std::ofstream(street + "/a.las") << "LASF and more";
       }},
      {3, "a.ply: has no labels", "export STREET/a.ply OUT.pgm",
       [](const std::string& street) {
         std::ofstream(street + "/a.ply") << asciiPly("x y z", "0 0 0\n0.1 0 0\n");
       }},
      {3, "a.pcd: has no labels", in + "OUT.pgm", cloud("", "0 0 0\n0.1 0 0\n")},
      {2, "no colour", in + "OUT.ply --colour rgb", road},
      {3, "a.pcd: the map has no voxel of the classes of the ground",
       in + "OUT.pgm --ground sidewalk", road},
      {2, "label 12 is beyond the 11 classes", in + "OUT.ply",
       cloud(" label", "0 0 0 1\n0.1 0 0 12\n")},
      {3, "a.pcd: has no point, expected one or more", in + "OUT.pgm",
       cloud(" label", "")},
      {3, "a.pcd: has no point to derive the voxel size from", in + "OUT.bt",
       cloud(" label", "")},
      {3, "a.pcd: the map reaches 40000 voxels", in + "OUT.bt --voxel-size 0.1",
       cloud(" label", "0 0 0 1\n0 4000.05 0 1\n")},
      {3, "a.pcd: the map is 100001 x 100001 columns", in + "OUT.pgm --voxel-size 1",
       cloud(" label", "0.5 0.5 0 3\n100000.5 100000.5 0 3\n")},
      {5, "calib.txt", in + "STREET/calib.txt/a.ply", road},
      {5, "b.bt: cannot be written: it is a folder", in + "STREET/b.bt",
       [=](const std::string& street) {
         road(street);
         fs::create_directory(street + "/b.bt");
       }},
      {3, "none.yaml", in + "OUT.ply --label-set none.yaml", road},
  });
}

TEST(ExportTool, SaysHowFarAnOctreeIsMovedAndThatThereIsNoPoint)
{
  const TemporaryFolder folder;
  cloud(" label", "0.08 0.05 0.05 1\n0.18 0.05 0.05 1\n")(folder.path());
  EXPECT_TRUE(
      holds(succeed("export " + folder.path("a.pcd") + " " + folder.path("a.bt")),
            "pcl_semantic_export: warning: the map is moved by -0.03 "));
  cloud(" label", "")(folder.path());
  for (const std::string name : {"a.ply", "a.bt --voxel-size 0.1"}) {
    const std::string said =
        succeed("export " + folder.path("a.pcd") + " " + folder.path(name));
    EXPECT_TRUE(holds(said, "a.pcd: no point is left"));
    EXPECT_TRUE(holds(said, "voxels: 0"));
  }
  EXPECT_TRUE(holds(bytesOf(folder.path("a.ply")), "element vertex 0"));
}

TEST(BadOutput, FullDiskOfExports)
{
  const ExportedMap& map = ExportedMap::instance();
  const TemporaryFolder folder;
  for (const std::string& path :
       {folder.path("a.ply"), folder.path("a.bt"), folder.path("a.pgm")})
    expectDiskFull("export " + map.path("map") + " " + path, 1200, path);
  EXPECT_EQ(folder.entries(), 0u);
}

} // namespace pcl_semantic
