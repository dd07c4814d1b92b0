// SPDX-License-Identifier: BSD-3-Clause

// Folders of clouds with additional files: poses, and files of another kind.

#include "support/ascii_cloud.h"
#include "support/bad_case.h"
#include "support/mapped_street.h"

#include <pcl_semantic/files/cloud_file.h>

namespace pcl_semantic {

namespace {

// One point of class 1, 5 m in front of a sensor.
void
writeCloud(const std::string& path, const std::string& viewpoint = "0 0 0 1 0 0 0")
{
  std::ofstream(path) << asciiCloud("x y z label", "5.03 0.03 0.03 1\n", 1, viewpoint);
}

class CloudFolders : public testing::Test {
protected:
  CloudFolders()
  {
    std::filesystem::create_directory(folder_.path("clouds"));
    folder_.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n"
                               "1 0 0 2 0 1 0 0 0 0 1 0\n");
  }

  std::string
  map(const std::string& poses)
  {
    return "map --clouds " + folder_.path("clouds") + " --crf none --quiet --output " +
           folder_.path("map") + " --poses " + poses;
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
  writeCloud(folder_.path("clouds/0.pcd"));
  writeCloud(folder_.path("clouds/2.pcd"));
  folder_.write("clouds/1.ply", asciiPly("x y z uchar:label", "5.03 2 0 1\n"));
  succeed(map(folder_.path("poses.txt")));
  EXPECT_EQ(readJson(folder_.path("map/summary.json"))["frame_numbers"],
            nlohmann::json({0, 1, 2}));

  writeCloud(folder_.path("clouds/1.pcd"));
  expectFails(map(folder_.path("poses.txt")), 3, "select one by a pattern");
}

TEST_F(CloudFolders, PosesOfTheirOwnAreUsedOrNamed)
{
  writeCloud(folder_.path("clouds/0.pcd"));
  writeCloud(folder_.path("clouds/1.pcd"), "10 0 0 1 0 0 0");
  writeCloud(folder_.path("clouds/2.pcd"), "20 0 0 1 0 0 0");
  const std::string other = succeed(map(folder_.path("poses.txt")));
  EXPECT_TRUE(holds(other, "1.pcd: its VIEWPOINT, at 10  0  0, is not used, its "
                           "pose of " +
                               folder_.path("poses.txt") + " is at 1 0 0"));
  EXPECT_EQ(std::count(other.begin(), other.end(), '\n'), 1) << other;

  EXPECT_EQ(succeed(map("viewpoint")), "");
  const std::vector<double> x = positions();
  ASSERT_EQ(x.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(x[i], 5.03 + 10.0 * double(i), 1e-3);
}

TEST_F(CloudFolders, OptionsOfLabelsAreRefusedWhereProbabilitiesAreUsed)
{
  const std::string poses = folder_.path("poses.txt");
  writeCloud(folder_.path("clouds/1.pcd"));
  LabelledCloud cloud = readLabelledCloud(folder_.path("clouds/1.pcd"));
  cloud.distributions = LabelDistributions(11, 1);
  cloud.distributions.setLabel(0, 3, 0.7f);
  writeLabelledCloud(folder_.path("clouds/2.pcd"), cloud);
  // The first cloud with labels has no probabilities, the other warns.
  succeed(map(poses + " --label-confidence 0.6"));
  EXPECT_TRUE(holds(succeed(map(poses + " --label-mapping zero_based")),
                    "2.pcd: a label mapping does not change its "
                    "probabilities, which are used"));
  std::filesystem::remove(folder_.path("clouds/1.pcd"));
  succeed(map(poses));
  const std::string none = " has no effect on the field 'probability' of ";
  expectFails(map(poses + " --label-confidence 0.6"), 2, "--label-confidence" + none);
  expectFails(map(poses + " --label-mapping zero_based"), 2, "--label-mapping" + none);
  expectFails("crf " + folder_.path("clouds/2.pcd") + " " + folder_.path("out.pcd") +
                  " --label-mapping zero_based" + of_kitti11,
              2, "--label-mapping" + none);
  LabelledCloud unnamed = readLabelledCloud(folder_.path("clouds/2.pcd"));
  unnamed.table.removeColumns("label");
  writeCloudTable(folder_.path("unnamed.pcd"), unnamed.table);
  expectFails("cloud " + folder_.path("unnamed.pcd") + " " + folder_.path("out.pcd") +
                  " --label-mapping zero_based" + of_kitti11,
              2, "--label-mapping" + none);
}

TEST_F(CloudFolders, CloudsInTheWorldsFrameAreRefused)
{
  folder_.write(
      "clouds/0.pcd",
      asciiCloud("x:F8 y:F8 z:F8 label",
                 "456005.03 5428000.5 112.5 1\n456006.03 5428001.5 112.5 1\n"));
  folder_.write("utm.txt", "1 0 0 456000 0 1 0 5428000 0 0 1 110\n");
  expectFails(map(folder_.path("utm.txt")), 3,
              "0.pcd: 2 of 2 points are more than 10000 m from the origin, "
              "as in the world frame; expected points in the sensor frame");
}

TEST_F(CloudFolders, PosesThatAreNoneAreRefused)
{
  writeCloud(folder_.path("clouds/0.pcd"), "0 0 0 0 0 0 0");
  expectFails(map("viewpoint"), 3, "frame 0: VIEWPOINT has the quaternion 0 0 0 0");
  expectFails({2, "--poses viewpoint is for --clouds",
               "--labels STREET/labels --poses viewpoint"});
  expectFails({2, "--poses viewpoint and --submap-every",
               "map --clouds STREET --poses viewpoint --submap-every 5 --output OUT"});
}

} // namespace pcl_semantic
