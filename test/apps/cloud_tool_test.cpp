// SPDX-License-Identifier: BSD-3-Clause
#include "support/ascii_cloud.h"
#include "support/bad_case.h"
#include "support/run_tool.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/files/cloud_file.h>
#include <pcl_semantic/files/trajectory_file.h>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace {

using namespace pcl_semantic;

// Points of a wall (1), a road (3) and a car (5) with an intensity, in one voxel of 1 m
// each.
class CloudTool : public testing::Test {
protected:
  CloudTool()
  {
    folder.write("in.pcd", asciiCloud("x y z intensity:F4 label",
                                      "0.1 0.1 0.1 7 1\n0.5 0.5 0.5 8 1\n"
                                      "0.9 0.9 0.9 9 3\n1.5 0.5 0.5 10 3\n"
                                      "2.5 0.5 0.5 11 5\n"));
  }

  LabelledCloud
  edited(const std::string& options, const std::string& input = "in.pcd") const
  {
    succeed("cloud " + folder.path(input) + " " + folder.path("out.pcd") + " " +
            options);
    return readLabelledCloud(folder.path("out.pcd"));
  }

  static std::vector<std::pair<double, int>>
  intensitiesAndLabels(const LabelledCloud& cloud)
  {
    const PcdColumn intensity(cloud.table, cloud.table.find("intensity"));
    std::vector<std::pair<double, int>> all;
    for (std::size_t i = 0; i < cloud.cloud->size(); ++i)
      all.emplace_back(intensity(i), int((*cloud.cloud)[i].label));
    return all;
  }

  using Points = std::vector<std::pair<double, int>>;

  TemporaryFolder folder;
};

} // namespace

TEST_F(CloudTool, CropsKeepsDropsAndRenames)
{
  EXPECT_EQ(intensitiesAndLabels(edited("--crop 0.4,0,0,2,1,1")),
            (Points{{8, 1}, {9, 3}, {10, 3}}));
  EXPECT_EQ(intensitiesAndLabels(edited("--keep 1,5")),
            (Points{{7, 1}, {8, 1}, {11, 5}}));
  EXPECT_EQ(intensitiesAndLabels(edited("--keep unlabelled,1")),
            intensitiesAndLabels(edited("--keep 0,1")));
  EXPECT_EQ(intensitiesAndLabels(
                edited("--drop road --relabel car=0,building=3 " + of_kitti11)),
            (Points{{7, 3}, {8, 3}, {11, 5}}))
      << "the fifth class of this label set is no car";
  const LabelledCloud cropped = edited("--crop 0,0,0,1,1,1");
  EXPECT_EQ(cropped.table.viewpoint[1], 2.0);
}

TEST_F(CloudTool, ThinsWithoutMixingClassesAndColours)
{
  EXPECT_EQ(intensitiesAndLabels(edited("--thin 1")),
            (Points{{8, 1}, {10, 3}, {11, 5}}));
  const LabelledCloud cloud = edited("--colour " + of_kitti11);
  ASSERT_TRUE(cloud.has_colour);
  EXPECT_EQ((*cloud.cloud)[0].rgba & 0xFFFFFFu, 0x800000u); // building
  EXPECT_EQ((*cloud.cloud)[2].rgba & 0xFFFFFFu, 0x804080u); // road
}

TEST_F(CloudTool, TurnsAScanOfKittiIntoAMap)
{
  const std::vector<float> points{5, 0, -1.5f, 0.5f, 6, 1, -1.5f, 0.25f};
  std::filesystem::create_directories(folder.path("scans"));
  folder.write("scans/000000.bin",
               {reinterpret_cast<const char*>(points.data()), 4 * points.size()});
  const std::uint32_t classes[] = {40, 252};
  folder.write("scans/000000.label", {reinterpret_cast<const char*>(classes), 8});
  const std::string mapping = "--label-mapping semantic_kitti_to_kitti11" + of_kitti11;
  const LabelledCloud cloud = edited(mapping, "scans/000000.bin");
  EXPECT_EQ(intensitiesAndLabels(cloud), (Points{{0.5, 3}, {0.25, 6}}));

  writeKittiTrajectory(folder.path("poses.txt"), {Eigen::Isometry3d::Identity()});
  succeed("map --clouds " + folder.path("scans") + " --poses " +
          folder.path("poses.txt") + " --crf none --output " + folder.path("map") +
          " " + mapping);
  EXPECT_EQ(readLabelledCloud(folder.path("map/map.pcd")).cloud->size(), 2u);
  succeed("crf " + folder.path("scans/000000.bin") + " " + folder.path("crf.pcd") +
          " " + mapping);
  expectFails("crf " + folder.path("scans/000000.bin") + " " + folder.path("none.pcd") +
                  " " + of_kitti11,
              3,
              "label 40 of point 0 is beyond the 11 classes of "
              "--label-set; other numbers need --label-mapping");
  EXPECT_EQ(readLabelledCloud(folder.path("crf.pcd")).distributions.classes(), 11);
}

// An empty cloud has the fields of the others, and every program takes it.
TEST_F(CloudTool, LeavesAnEmptyCloudWithTheSameFields)
{
  for (const std::string& options : std::vector<std::string>{
           "--keep 7", "--drop 1,3,5", "--crop 90,0,0,91,1,1", "--keep 7 --thin 1",
           "--crop 90,0,0,91,1,1 --colour " + of_kitti11}) {
    const std::string text = succeed("cloud " + folder.path("in.pcd") + " " +
                                     folder.path("out.pcd") + " " + options);
    EXPECT_TRUE(holds(text, "no point is left")) << options;
    const LabelledCloud cloud = readLabelledCloud(folder.path("out.pcd"));
    EXPECT_EQ(cloud.cloud->size(), 0u);
    EXPECT_EQ(cloud.table.fields.size(), options.find("colour") < 99 ? 6u : 5u);
    EXPECT_EQ(cloud.table.viewpoint[1], 2.0);
  }
  folder.write("empty.ply", asciiPly("x y z", ""));
  for (const std::string input : {"out.pcd", "empty.ply"})
    for (const std::string program :
         {"cloud IN OUT --thin 0.1", "cloud IN OUT --crop 0,0,0,1,1,1", "crf IN OUT",
          "crf IN OUT --crf hierarchical --cliques cubes:1",
          "cliques IN OUT --method cubes:1", "cliques IN OUT --method supervoxel:1",
          "cliques IN OUT --method slic"}) {
      const std::string command =
          replaceAll(replaceAll(program, "IN", folder.path(input)), "OUT",
                     folder.path("again.pcd"));
      EXPECT_TRUE(holds(succeed(command), "no point is left")) << command;
      EXPECT_EQ(readLabelledCloud(folder.path("again.pcd")).cloud->size(), 0u);
    }
}

TEST_F(CloudTool, TellsOfNumbersThatAMappingLacks)
{
  folder.write("m.yaml", "classes:\n  road: [1]\nunlabelled: [3]\n");
  const std::string options =
      " --label-mapping " + folder.path("m.yaml") + " " + of_kitti11;
  for (const std::string program : {"cloud ", "crf "})
    EXPECT_TRUE(holds(succeed(program + folder.path("in.pcd") + " " +
                              folder.path("out.pcd") + options),
                      "m.yaml lacks 1 numbers of the input: 5 (1 points): they count "
                      "as unlabelled\n"));
}

// Numbers that are no labels of ours do not matter to cliques.
TEST_F(CloudTool, GroupsCloudsOfAnyLabels)
{
  folder.write("raw.ply", asciiPly("x y z int:label", "1 2 3 259\n4 5 6 -1\n"));
  succeed("cliques " + folder.path("raw.ply") + " " + folder.path("out.pcd") +
          " --method cubes:1");
  const PcdTable table = readCloudTable(folder.path("out.pcd"));
  EXPECT_EQ(PcdColumn(table, table.find("label"))(0), 259.0);
}

TEST_F(CloudTool, CountsNoReturns)
{
  std::string rows;
  for (int i = 0; i < 4; ++i)
    rows += "0 0 0 2\n" + std::to_string(i) + " 1 1 3\n";
  folder.write("zeros.pcd", asciiCloud("x y z label", rows));
  const auto pointsOf = [&](const std::string& program, const std::string& options) {
    EXPECT_TRUE(holds(succeed(program + " " + folder.path("zeros.pcd") + " " +
                              folder.path("out.pcd") + options),
                      "zeros.pcd: 4 points at exactly 0 0 0 count as no return"));
    return readLabelledCloud(folder.path("out.pcd"));
  };
  EXPECT_EQ(pointsOf("cloud", " --thin 0.5").cloud->size(), 4u);
  EXPECT_EQ(pointsOf("cloud", " --crop -1,-1,-1,1,2,2").cloud->size(), 2u);
  EXPECT_EQ(pointsOf("cloud", " --keep 2").cloud->size(), 4u);
  EXPECT_EQ((*pointsOf("crf", "").cloud)[0].label, 2u);
  EXPECT_EQ(pointsOf("cliques", " --method cubes:9").cliques.size(), 1u);
}

TEST_F(CloudTool, RefusesWhatCannotBe)
{
  const auto fails = [&](const std::string& options, int code, const std::string& says,
                         const std::string& input = "in.pcd") {
    expectFails("cloud " + folder.path(input) + " " + folder.path("out.pcd") + " " +
                    options,
                code, says);
    EXPECT_FALSE(std::ifstream(folder.path("out.pcd")).good()) << options;
  };
  for (const auto& [options, says] : std::vector<std::pair<std::string, const char*>>{
           {"--crop 0,0,0,1,1", "--crop: expected x0,y0,z0,x1,y1,z1"},
           {"--crop 1,0,0,0,1,1", "--crop: expected x0,y0,z0,x1,y1,z1"},
           {"--crop a,b", "--crop"},
           {"--keep car", "names need --label-set"},
           {"--drop cra" + of_kitti11, "is no class of the label set"},
           {"--relabel 3", "expected OLD=NEW"},
           {"--thin 0", "--thin is 0, expected more than 0"},
           {"--thin 1e-12", "take larger ones"},
           {"--colour", "need --label-set"},
           {"--scan-columns x,y", "scan columns 'x,y' have no z"}})
    fails(options, 2, says);
  fails("--label-mapping none_such " + of_kitti11, 3, "none_such");
  folder.write("bare.ply", asciiPly("x y z uchar:lbl uchar:my_label", "1 2 3 4 5\n"));
  for (const std::string option : {"--thin 1", "--keep 1"})
    fails(option, 3,
          "bare.ply: has no field 'label' or 'probability', which " +
              option.substr(0, 6) + " needs; field 'my_label' is not read as labels",
          "bare.ply");
  folder.write("float.ply",
               asciiPly("x y z label", "1 2 3 19660801\n")); // 300 << 16 | 1
  fails("--thin 1", 3, "float.ply: field 'label': point 0 has 19660800, where single",
        "float.ply");
}
