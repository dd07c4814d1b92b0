// SPDX-License-Identifier: BSD-3-Clause

// Folders of clouds with additional files: poses, and files of another kind.

#include "support/bad_case.h"
#include "support/mapped_street.h"

#include <pcl_semantic/files/cloud_file.h>

namespace pcl_semantic {

namespace {

// One point of class 1, 5 m in front of a sensor.
void
writeCloud(const std::string& path, const std::string& viewpoint)
{
  std::ofstream(path) << "VERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F F F U\n"
                         "COUNT 1 1 1 1\nWIDTH 1\nHEIGHT 1\nVIEWPOINT "
                      << viewpoint << "\nPOINTS 1\nDATA ascii\n5.03 0.03 0.03 1\n";
}

const std::string identity = "0 0 0 1 0 0 0";

class CloudFolders : public testing::Test {
protected:
  CloudFolders()
  {
    std::filesystem::create_directory(folder_.path("clouds"));
    folder_.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"
                               "1 0 0 2 0 1 0 0 0 0 1 0\n");
  }

  ToolResult
  map(const std::string& poses)
  {
    return runTool("map --clouds " + folder_.path("clouds") + " --crf none --quiet " +
                   "--output " + folder_.path("map") + " --poses " + poses);
  }

  // x of the voxels [m]
  std::vector<double>
  positions()
  {
    const LabelledCloud cloud = readLabelledCloud(folder_.path("map/map.pcd"));
    std::vector<double> all;
    for (const auto& point : *cloud.cloud)
      all.push_back(point.x);
    std::sort(all.begin(), all.end());
    return all;
  }

  TemporaryFolder folder_;
};

} // namespace

TEST_F(CloudFolders, AllKindsOfCloudsAreFrames)
{
  writeCloud(folder_.path("clouds/0.pcd"), identity);
  writeCloud(folder_.path("clouds/2.pcd"), identity);
  folder_.write("clouds/1.ply",
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty "
                "float y\nproperty float z\nproperty uchar label\nend_header\n"
                "5.03 2 0 1\n");
  const ToolResult result = map(folder_.path("poses.txt"));
  EXPECT_EQ(result.code, 0) << result.text;
  EXPECT_EQ(readJson(folder_.path("map/summary.json"))["frame_numbers"],
            nlohmann::json({0, 1, 2}));

  writeCloud(folder_.path("clouds/1.pcd"), identity);
  const ToolResult twice = map(folder_.path("poses.txt"));
  EXPECT_EQ(twice.code, 3);
  EXPECT_TRUE(holds(twice.text, "select one by a pattern"));
}

TEST_F(CloudFolders, PosesOfTheirOwnAreUsedOrNamed)
{
  writeCloud(folder_.path("clouds/0.pcd"), identity);
  writeCloud(folder_.path("clouds/1.pcd"), "10 0 0 1 0 0 0");
  writeCloud(folder_.path("clouds/2.pcd"), "20 0 0 1 0 0 0");
  const ToolResult other = map(folder_.path("poses.txt"));
  EXPECT_EQ(other.code, 0);
  EXPECT_TRUE(holds(other.text, "1.pcd: its VIEWPOINT, at 10  0  0, is not used, its "
                                "pose of " +
                                    folder_.path("poses.txt") + " is at 1 0 0"));
  EXPECT_EQ(std::count(other.text.begin(), other.text.end(), '\n'), 1) << other.text;

  const ToolResult own = map("viewpoint");
  EXPECT_EQ(own.code, 0);
  EXPECT_EQ(own.text, "");
  const std::vector<double> x = positions();
  ASSERT_EQ(x.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(x[i], 5.03 + 10.0 * double(i), 1e-3);
}

TEST_F(CloudFolders, OptionsOfLabelsAreRefusedWhereProbabilitiesAreUsed)
{
  const std::string poses = folder_.path("poses.txt");
  writeCloud(folder_.path("clouds/1.pcd"), identity);
  LabelledCloud cloud = readLabelledCloud(folder_.path("clouds/1.pcd"));
  cloud.distributions = LabelDistributions(11, 1);
  cloud.distributions.setLabel(0, 3, 0.7f);
  writeLabelledCloud(folder_.path("clouds/2.pcd"), cloud);
  // The first cloud with labels has no probabilities, the other warns.
  EXPECT_EQ(map(poses + " --label-confidence 0.6").code, 0);
  const ToolResult mixed = map(poses + " --label-mapping zero_based");
  EXPECT_EQ(mixed.code, 0);
  EXPECT_TRUE(holds(mixed.text, "2.pcd: a label mapping does not change its "
                                "probabilities, which are used"));
  std::filesystem::remove(folder_.path("clouds/1.pcd"));
  EXPECT_EQ(map(poses).code, 0);
  for (const char* const option : {"--label-confidence", "--label-mapping"}) {
    const ToolResult refused =
        map(poses + " " + option +
            (std::string(option) == "--label-mapping" ? " zero_based" : " 0.6"));
    EXPECT_EQ(refused.code, 2) << option;
    EXPECT_TRUE(holds(refused.text, option + std::string(" has no effect on the field "
                                                         "'probability' of ")));
  }
  const std::string label_set =
      " --label-set " PCL_SEMANTIC_SOURCE_DIR "/data/label_sets/kitti11.yaml";
  expectFails("crf " + folder_.path("clouds/2.pcd") + " " + folder_.path("out.pcd") +
                  " --label-mapping zero_based" + label_set,
              2, "--label-mapping has no effect on the field 'probability' of ");
  LabelledCloud unnamed = readLabelledCloud(folder_.path("clouds/2.pcd"));
  unnamed.table.removeColumns("label");
  writeCloudTable(folder_.path("unnamed.pcd"), unnamed.table);
  expectFails("cloud " + folder_.path("unnamed.pcd") + " " + folder_.path("out.pcd") +
                  " --label-mapping zero_based" + label_set,
              2, "--label-mapping has no effect on the field 'probability' of ");
}

TEST_F(CloudFolders, CloudsInTheWorldsFrameAreRefused)
{
  folder_.write("clouds/0.pcd",
                "VERSION 0.7\nFIELDS x y z label\nSIZE 8 8 8 4\nTYPE F F F U\n"
                "COUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n"
                "456005.03 5428000.5 112.5 1\n456006.03 5428001.5 112.5 1\n");
  folder_.write("utm.txt", "1 0 0 456000 0 1 0 5428000 0 0 1 110\n");
  const ToolResult result = map(folder_.path("utm.txt"));
  EXPECT_EQ(result.code, 3);
  EXPECT_TRUE(holds(result.text,
                    "0.pcd: 2 of 2 points are more than 10000 m from the origin, "
                    "as in the world frame; expected points in the sensor frame"));
}

TEST_F(CloudFolders, PosesThatAreNoneAreRefused)
{
  writeCloud(folder_.path("clouds/0.pcd"), "0 0 0 0 0 0 0");
  const ToolResult result = map("viewpoint");
  EXPECT_EQ(result.code, 3);
  EXPECT_TRUE(holds(result.text, "frame 0: VIEWPOINT has the quaternion 0 0 0 0"));
  expectFails({"images", 2, "--poses viewpoint is for --clouds",
               "--labels STREET/labels --poses viewpoint"});
  expectFails({"submaps", 2, "--poses viewpoint and --submap-every",
               "map --clouds STREET --poses viewpoint --submap-every 5 --output OUT"});
}

} // namespace pcl_semantic
