// SPDX-License-Identifier: BSD-3-Clause

// What we write as PLY, read by PCL and compared with the voxels one by one.

#include "support/random_scene.h"
#include "support/temporary_folder.h"
#include "support/thrown_message.h"

#include <pcl_semantic/pictures/ply_file.h>

#include <gtest/gtest.h>
#include <pcl/io/ply_io.h>

using namespace pcl_semantic;

TEST(PlyPoints, AreReadByPcl)
{
  const TemporaryFolder folder;
  const VoxelScene scene = randomScene(1);
  const std::vector<cv::Vec3b> colours = randomColours(scene, 2);
  writePlyPoints(folder.path("a.ply"), scene, colours);
  pcl::PointCloud<pcl::PointXYZRGBL> cloud;
  ASSERT_EQ(pcl::io::loadPLYFile(folder.path("a.ply"), cloud), 0);
  ASSERT_EQ(cloud.size(), scene.voxels.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(cloud[i].label, (*scene.voxels.cloud)[i].label);
    EXPECT_EQ(cv::Vec3b(cloud[i].b, cloud[i].g, cloud[i].r), colours[i]);
    EXPECT_EQ(cloud[i].getVector3fMap(),
              (*scene.voxels.cloud)[i].getVector3fMap()); // as map.pcd has them
  }
  EXPECT_NE(bytesOf(folder.path("a.ply")).find("\ncomment origin 1000 -2000 0\n"),
            std::string::npos);
}

TEST(PlyPoints, RefuseOtherNumbersOfColours)
{
  const TemporaryFolder folder;
  expectBadParameter("1 colours for", [&] {
    writePlyPoints(folder.path("a.ply"), randomScene(7), {{}});
  });
  EXPECT_EQ(folder.entries(), 0u);
}
